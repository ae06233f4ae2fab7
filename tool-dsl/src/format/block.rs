//! Statements, their blocks, and the comments around them.

use super::token::{Kind, Token};
use super::{INDENT_WIDTH, LINE_WIDTH, line};

/// An element of a block, on lines of its own.
pub(super) enum Node<'t> {
    /// Comments on a line of their own.
    Comments(Comments<'t>),
    /// An item, a property or a segment.
    Statement(Statement<'t>),
}

pub(super) struct Comments<'t> {
    /// True if a blank line precedes it.
    blank: bool,
    run: &'t [Token<'t>],
}

pub(super) struct Statement<'t> {
    /// True if a blank line precedes it.
    blank: bool,
    /// The tokens up to its `;` or `{`.
    code: &'t [Token<'t>],
    /// Comments after that on the same line.
    trailing_comments: &'t [Token<'t>],
    body: Option<Body<'t>>,
}

struct Body<'t> {
    nodes: Vec<Node<'t>>,
    /// Its `}`, or nothing if the text ends before.
    closing_brace: &'static str,
    /// Comments after its `}` on the same line.
    trailing_comments: &'t [Token<'t>],
    /// True if it was written on one line and may stay there.
    one_line: bool,
}

/// Returns the nodes of a whole text.
pub(super) fn nodes<'t>(tokens: &'t [Token<'t>]) -> Vec<Node<'t>> {
    Reader { tokens, at: 0 }.nodes(false)
}

struct Reader<'t> {
    tokens: &'t [Token<'t>],
    at: usize,
}

impl<'t> Reader<'t> {
    fn nodes(&mut self, nested: bool) -> Vec<Node<'t>> {
        let mut nodes = Vec::new();
        while let Some(next) = self.tokens.get(self.at) {
            if nested && next.is("}") {
                break;
            }
            let blank = next.newlines > 1 && !nodes.is_empty();
            let run = self.comments();
            if run.iter().any(|comment| comment.kind == Kind::Ending) || self.ends_line(run) {
                self.at += run.len();
                nodes.push(Node::Comments(Comments { blank, run }));
            } else {
                nodes.push(Node::Statement(self.statement(blank)));
            }
        }
        nodes
    }

    /// Returns the next comments that are on one line.
    fn comments(&self) -> &'t [Token<'t>] {
        let rest = &self.tokens[self.at..];
        let run = rest
            .iter()
            .enumerate()
            .take_while(|(at, token)| token.is_comment() && (*at == 0 || token.newlines == 0));
        &rest[..run.count()]
    }

    /// Returns whether there are comments that end their line, except for a `}` after them.
    fn ends_line(&self, run: &[Token<'_>]) -> bool {
        let next = self.tokens.get(self.at + run.len());
        !run.is_empty() && next.is_none_or(|token| token.newlines > 0 || token.is("}"))
    }

    /// Consumes the comments on the same line as the last token.
    fn trailing_comments(&mut self) -> &'t [Token<'t>] {
        let run = match self.tokens.get(self.at) {
            Some(next) if next.newlines == 0 => self.comments(),
            _ => &[],
        };
        let run = if self.ends_line(run) { run } else { &[] };
        self.at += run.len();
        run
    }

    fn statement(&mut self, blank: bool) -> Statement<'t> {
        let start = self.at;
        let mut list = false;
        let mut opens = false;
        while let Some(token) = self.tokens.get(self.at) {
            let alone = self.at == start;
            if token.is("}") && !list && !alone {
                break;
            }
            self.at += 1;
            list |= token.is("bsp") && token.kind == Kind::Word;
            opens = token.is("{") && !list;
            if opens || token.is(";") || token.is("}") {
                break;
            }
        }
        let code = &self.tokens[start..self.at];
        let trailing_comments = self.trailing_comments();
        let body = opens.then(|| self.body(code, trailing_comments));
        Statement { blank, code, trailing_comments, body }
    }

    fn body(&mut self, head: &[Token<'_>], trailing_comments: &[Token<'_>]) -> Body<'t> {
        let start = self.at;
        let nodes = self.nodes(true);
        let closing_brace = if self.at < self.tokens.len() { "}" } else { "" };
        self.at += closing_brace.len();
        let inside = &self.tokens[start..self.at];
        let one_line = head.first().is_some_and(|word| word.is("region"))
            && nodes.len() == 1
            && !closing_brace.is_empty()
            && trailing_comments.is_empty()
            && inside.iter().all(|token| token.newlines == 0 && !token.is_comment());
        Body { nodes, closing_brace, trailing_comments: self.trailing_comments(), one_line }
    }
}

/// Writes nodes as text.
pub(super) fn write(nodes: &[Node<'_>]) -> String {
    let mut page = String::new();
    write_at(nodes, 0, &mut page);
    page
}

fn write_at(nodes: &[Node<'_>], indent: usize, page: &mut String) {
    for node in nodes {
        let (Node::Comments(Comments { blank, .. }) | Node::Statement(Statement { blank, .. })) =
            node;
        if *blank {
            page.push('\n');
        }
        match node {
            Node::Comments(comments) => line::write(comments.run, indent, page),
            Node::Statement(statement) => statement.write(indent, page),
        }
        page.push('\n');
    }
}

impl Statement<'_> {
    fn write(&self, indent: usize, page: &mut String) {
        if let Some(line) = self.on_one_line()
            && indent + line.chars().count() <= LINE_WIDTH
        {
            page.extend(std::iter::repeat_n(' ', indent));
            page.push_str(&line);
        } else {
            line::write(self.code, indent, page);
            trailing_comments(self.trailing_comments, page);
            if let Some(body) = &self.body {
                if !(body.nodes.is_empty() && self.trailing_comments.is_empty()) {
                    page.push('\n');
                    write_at(&body.nodes, indent + INDENT_WIDTH, page);
                    page.extend(std::iter::repeat_n(' ', indent));
                }
                page.push_str(body.closing_brace);
            }
        }
        if let Some(body) = &self.body {
            trailing_comments(body.trailing_comments, page);
        }
    }

    /// Returns the line of a region with one property that was written on one line.
    fn on_one_line(&self) -> Option<String> {
        let body = self.body.as_ref().filter(|body| body.one_line)?;
        let [Node::Statement(property)] = body.nodes.as_slice() else { return None };
        if self.code.iter().any(|token| token.kind == Kind::Ending) || property.body.is_some() {
            return None;
        }
        Some(format!("{} {} }}", line::joined(self.code), line::joined(property.code)))
    }
}

fn trailing_comments(comments: &[Token<'_>], page: &mut String) {
    for comment in comments {
        page.push(' ');
        page.push_str(comment.text);
    }
}
