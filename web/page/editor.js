// The editor of a tool's text, with the compiler's diagnostics.

import { defaultKeymap, history, historyKeymap, indentWithTab } from '@codemirror/commands';
import { HighlightStyle, StreamLanguage, bracketMatching, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, setDiagnostics } from '@codemirror/lint';
import { EditorState, StateEffect, StateField } from '@codemirror/state';
import { EditorView, highlightActiveLine, keymap, lineNumbers, showTooltip } from '@codemirror/view';
import { tags } from '@lezer/highlight';

/**
 * @typedef {{severity: 'error' | 'warning' | 'info', code: string, message: string, help: string, from: number, to: number,
 *   file: string | null}} Diagnostic
 */

const KEYWORDS = new Set(('tool solid units let param curve tip spindle profile start line arc to center radius concave as ' +
  'cutting mount with at regions nearest smooth region where depth magnitude niceness direction away toward from allow bsp').split(' '));

/** The words, numbers and comments of the language of tools. */
const language = StreamLanguage.define({
  name: 'tool',
  startState: () => ({ depth: 0 }),
  token(stream, state) {
    if (state.depth > 0 || stream.match('/*')) {
      // Comments nest.
      if (state.depth === 0) state.depth = 1;
      while (state.depth > 0 && !stream.eol()) {
        if (stream.match('*/')) state.depth--;
        else if (stream.match('/*')) state.depth++;
        else stream.next();
      }
      return 'comment';
    }
    if (stream.match(/^\/\/.*/)) return 'comment';
    if (stream.match(/^"[^"]*"?/)) return 'string';
    if (stream.match(/^\d+(\.\d+)?([eE][+-]?\d+)?/)) return 'number';
    const word = stream.match(/^[A-Za-z_][A-Za-z0-9_]*/);
    if (word) return KEYWORDS.has(word[0]) ? 'keyword' : 'variableName';
    stream.next();
    return null;
  },
  languageData: { commentTokens: { line: '//' } },
});

const colors = HighlightStyle.define([
  { tag: tags.keyword, color: '#0b5cad' },
  { tag: tags.comment, color: '#5b6775', fontStyle: 'italic' },
  { tag: tags.string, color: '#8a3b12' },
  { tag: tags.number, color: '#176639' },
]);

const setProblems = StateEffect.define();

/** The diagnostics of the text as it was when they were computed. */
const problems = StateField.define({
  create: () => /** @type {Diagnostic[]} */ ([]),
  update(list, transaction) {
    for (const effect of transaction.effects) if (effect.is(setProblems)) return effect.value;
    if (!transaction.docChanged) return list;
    return list.map((one) => ({ ...one, from: transaction.changes.mapPos(one.from), to: transaction.changes.mapPos(one.to) }));
  },
});

/** Returns the diagnostic at the cursor, or else on its line. */
function atCursor(state) {
  const at = state.selection.main.head;
  const line = state.doc.lineAt(at);
  const list = state.field(problems).filter(({ file }) => file === null);
  return list.find(({ from, to }) => from <= at && at <= to) ?? list.find(({ from, to }) => from <= line.to && to >= line.from);
}

/** Shows the diagnostic at the cursor under it, with its remedy. */
const underCursor = showTooltip.compute([problems, 'selection', 'doc'], (state) => {
  const found = atCursor(state);
  if (!found) return null;
  const create = () => {
    const dom = document.createElement('div');
    dom.className = `cm-problem ${found.severity}`;
    const title = document.createElement('b');
    const code = document.createElement('code');
    code.textContent = ` ${found.code}`;
    title.append(found.message, code);
    dom.append(title, found.help);
    return { dom };
  };
  return { pos: Math.min(state.selection.main.head, state.doc.length), above: false, strictSide: true, create };
});

export class Editor {
  /**
   * @param {HTMLElement} parent
   * @param {(text: string) => void} changed is called with the text a moment after each change
   */
  constructor(parent, changed) {
    let timer = 0;
    this.silent = false;
    const listener = EditorView.updateListener.of((update) => {
      if (!update.docChanged || this.silent) return;
      clearTimeout(timer);
      timer = setTimeout(() => changed(this.text), 20);
    });
    const extensions = [
      lineNumbers(), history(), bracketMatching(), highlightActiveLine(), lintGutter(), language, syntaxHighlighting(colors),
      keymap.of([...defaultKeymap, ...historyKeymap, indentWithTab]), problems, underCursor, listener,
      EditorView.contentAttributes.of({ 'aria-label': 'text of the tool' }),
    ];
    this.view = new EditorView({ parent, state: EditorState.create({ doc: '', extensions }) });
  }

  get text() {
    return this.view.state.doc.toString();
  }

  /** Replaces the text, without a call of `changed`. */
  set text(text) {
    this.silent = true;
    this.view.dispatch({ changes: { from: 0, to: this.view.state.doc.length, insert: text } });
    this.silent = false;
  }

  /** @param {Diagnostic[]} list */
  show(list) {
    const length = this.view.state.doc.length;
    const own = list.filter(({ file }) => file === null).map((one) => {
      const from = Math.min(one.from, length);
      return { ...one, from, to: Math.max(from, Math.min(one.to, length)) };
    });
    const marks = own.map(({ from, to, severity, message, help }) => ({ from, to, severity, message: `${message}\n${help}` }));
    this.view.dispatch(setDiagnostics(this.view.state, marks));
    this.view.dispatch({ effects: setProblems.of(own) });
  }
}
