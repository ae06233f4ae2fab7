//! The public interfaces of the libraries, kept as snapshots, so that each change of it is seen.
//!
//! The items are read from the source text: `cargo public-api` needs a nightly toolchain. Items that macros write,
//! as the vector types of [`touchoff::tool`], are not seen.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::{Attribute, File, Item, ItemImpl, Type, UseTree, Visibility};

/// A module of the crate, with the items that it declares.
#[derive(Default)]
struct Module {
    items: BTreeMap<String, Vec<Item>>,
    children: BTreeMap<String, (bool, Module)>,
    /// Public re-exports: the new name, or none for a glob, and the path.
    exports: Vec<(Option<String>, Vec<String>)>,
}

/// All modules of a crate, and its implementations by the name of their type.
#[derive(Default)]
struct Crate {
    root: Module,
    impls: BTreeMap<String, Vec<ItemImpl>>,
}

/// Returns whether an item has an attribute with a word, as `cfg(test)` or `doc(hidden)`.
fn has(attributes: &[Attribute], name: &str, word: &str) -> bool {
    attributes.iter().any(|attribute| {
        let syn::Meta::List(list) = &attribute.meta else { return false };
        list.path.is_ident(name) && list.tokens.to_string().contains(word)
    })
}

fn is_test(attributes: &[Attribute]) -> bool {
    has(attributes, "cfg", "test")
}

fn is_hidden(attributes: &[Attribute]) -> bool {
    has(attributes, "doc", "hidden")
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Keeps the attributes that are part of the interface.
fn keep(attributes: &mut Vec<Attribute>) {
    let kept = ["derive", "non_exhaustive", "cfg", "must_use", "repr"];
    attributes.retain(|attribute| kept.iter().any(|name| attribute.path().is_ident(name)));
}

/// Returns the name, the attributes and the visibility of an item that can be part of an interface.
fn parts(item: &mut Item) -> Option<(String, &mut Vec<Attribute>, &Visibility)> {
    let (name, attributes, visibility) = match item {
        Item::Struct(item) => (&item.ident, &mut item.attrs, &item.vis),
        Item::Enum(item) => (&item.ident, &mut item.attrs, &item.vis),
        Item::Trait(item) => (&item.ident, &mut item.attrs, &item.vis),
        Item::Fn(item) => (&item.sig.ident, &mut item.attrs, &item.vis),
        Item::Const(item) => (&item.ident, &mut item.attrs, &item.vis),
        Item::Type(item) => (&item.ident, &mut item.attrs, &item.vis),
        _ => return None,
    };
    Some((name.to_string(), attributes, visibility))
}

/// Removes what callers cannot see within an item: documentation, bodies, private fields.
fn strip(item: &mut Item) {
    match item {
        Item::Struct(item) => strip_fields(&mut item.fields),
        Item::Enum(item) => {
            for variant in &mut item.variants {
                keep(&mut variant.attrs);
                variant.fields.iter_mut().for_each(|field| keep(&mut field.attrs));
            }
        }
        Item::Trait(item) => {
            for item in &mut item.items {
                if let syn::TraitItem::Fn(item) = item {
                    keep(&mut item.attrs);
                    item.default = item.default.take().map(|_| syn::parse_quote!({}));
                }
            }
        }
        Item::Fn(item) => *item.block = syn::parse_quote!({}),
        Item::Const(item) => *item.expr = syn::parse_quote!(..),
        _ => {}
    }
}

fn strip_fields(fields: &mut syn::Fields) {
    match fields {
        syn::Fields::Named(fields) => {
            let all = std::mem::take(&mut fields.named).into_iter();
            fields.named = all.filter(|field| is_public(&field.vis)).collect();
            fields.named.iter_mut().for_each(|field| keep(&mut field.attrs));
        }
        syn::Fields::Unnamed(fields) => {
            for field in &mut fields.unnamed {
                keep(&mut field.attrs);
                if !is_public(&field.vis) {
                    field.ty = syn::parse_quote!(_);
                }
            }
        }
        syn::Fields::Unit => {}
    }
}

/// Returns the public functions and constants of an implementation, without bodies; of a trait's only the head.
fn strip_impl(mut item: ItemImpl) -> Option<ItemImpl> {
    keep(&mut item.attrs);
    if item.trait_.is_some() {
        item.items.clear();
        return Some(item);
    }
    item.items.retain_mut(|item| match item {
        syn::ImplItem::Fn(function) => {
            let shown = is_public(&function.vis) && !is_hidden(&function.attrs);
            keep(&mut function.attrs);
            function.block = syn::parse_quote!({});
            shown
        }
        syn::ImplItem::Const(constant) => {
            keep(&mut constant.attrs);
            constant.expr = syn::parse_quote!(..);
            is_public(&constant.vis)
        }
        _ => false,
    });
    (!item.items.is_empty()).then_some(item)
}

fn exports(tree: &UseTree, path: &[String], to: &mut Vec<(Option<String>, Vec<String>)>) {
    let longer = |name: String| [path, &[name]].concat();
    let mut add = |name: &syn::Ident, as_name: &syn::Ident| {
        to.push((Some(as_name.to_string()), longer(name.to_string())));
    };
    match tree {
        UseTree::Path(tree) => exports(&tree.tree, &longer(tree.ident.to_string()), to),
        UseTree::Name(tree) => add(&tree.ident, &tree.ident),
        UseTree::Rename(tree) => add(&tree.ident, &tree.rename),
        UseTree::Glob(_) => to.push((None, path.to_vec())),
        UseTree::Group(tree) => tree.items.iter().for_each(|tree| exports(tree, path, to)),
    }
}

/// Returns the enumeration that `faults!` declares; any other item as it is.
fn declared(item: Item) -> Item {
    match &item {
        Item::Macro(invoked) if invoked.mac.path.is_ident("faults") => {
            invoked.mac.parse_body().expect("an enumeration")
        }
        _ => item,
    }
}

impl Crate {
    /// Reads a module's items, and the files of its children, which lie in a folder.
    fn read(&mut self, items: Vec<Item>, folder: &Path) -> Module {
        let mut module = Module::default();
        for mut item in items.into_iter().map(declared) {
            match &item {
                Item::Mod(child) => {
                    if is_test(&child.attrs) || is_hidden(&child.attrs) {
                        continue;
                    }
                    let name = child.ident.to_string();
                    let items = match &child.content {
                        Some((_, items)) => items.clone(),
                        None => parsed(folder, &name).items,
                    };
                    let read = self.read(items, &folder.join(&name));
                    module.children.insert(name, (is_public(&child.vis), read));
                    continue;
                }
                Item::Use(item) => {
                    if is_public(&item.vis) && !is_hidden(&item.attrs) {
                        exports(&item.tree, &[], &mut module.exports);
                    }
                    continue;
                }
                Item::Impl(item) => {
                    if let Type::Path(path) = &*item.self_ty
                        && !is_test(&item.attrs)
                        && let Some(last) = path.path.segments.last()
                        && let Some(kept) = strip_impl(item.clone())
                    {
                        self.impls.entry(last.ident.to_string()).or_default().push(kept);
                    }
                    continue;
                }
                _ => {}
            }
            let Some((name, attributes, visibility)) = parts(&mut item) else { continue };
            if is_public(visibility) && !is_test(attributes) && !is_hidden(attributes) {
                keep(attributes);
                strip(&mut item);
                module.items.entry(name).or_default().push(item);
            }
        }
        module
    }

    /// Returns the module at a path from another, or none outside the crate.
    fn module(&self, at: &[String], path: &[String]) -> Option<(&Module, Vec<String>)> {
        let mut place: Vec<String> = match path.first().map(String::as_str) {
            Some("crate") => Vec::new(),
            _ => at.to_vec(),
        };
        for name in path {
            match name.as_str() {
                "crate" | "self" => {}
                "super" => {
                    place.pop();
                }
                name => place.push(name.to_owned()),
            }
        }
        let mut module = &self.root;
        for name in &place {
            module = &module.children.get(name)?.1;
        }
        Some((module, place))
    }

    /// Writes the public items of a module under a public path.
    fn list(&self, at: &[String], public: &str, to: &mut BTreeMap<String, (String, Vec<Item>)>) {
        let (module, _) = self.module(at, &[]).expect("a module that was read");
        let mut add = |name: &str, home: &[String], items: &[Item]| {
            let declared = format!("{}::{name}", home.join("::"));
            to.insert(format!("{public}::{name}"), (declared, items.to_vec()));
        };
        for (name, items) in &module.items {
            add(name, at, items);
        }
        let longer = |path: &[String], name: &String| [path, std::slice::from_ref(name)].concat();
        let mut below: Vec<(Vec<String>, String)> = Vec::new();
        for (name, _) in module.children.iter().filter(|(_, (is_public, _))| *is_public) {
            below.push((longer(at, name), format!("{public}::{name}")));
        }
        for (name, path) in &module.exports {
            let Some(name) = name else {
                if let Some((_, place)) = self.module(at, path) {
                    below.push((place, public.to_owned()));
                }
                continue;
            };
            let (last, parents) = path.split_last().expect("a name");
            let Some((home, place)) = self.module(at, parents) else { continue };
            if let Some((home, last)) = self.declaration(home, &place, last) {
                let (module, _) = self.module(&home, &[]).expect("a module that was read");
                add(name, &home, &module.items[&last]);
            } else if home.children.contains_key(last) {
                below.push((longer(&place, last), format!("{public}::{name}")));
            }
        }
        for (place, public) in below {
            self.list(&place, &public, to);
        }
    }

    /// Follows re-exports to the module that declares an item.
    fn declaration(
        &self,
        module: &Module,
        at: &[String],
        name: &str,
    ) -> Option<(Vec<String>, String)> {
        if module.items.contains_key(name) {
            return Some((at.to_vec(), name.to_owned()));
        }
        let own = name.to_owned();
        module.exports.iter().find_map(|(known, path)| {
            let (last, parents) = match known {
                Some(known) if known == name => path.split_last()?,
                None => (&own, path.as_slice()),
                Some(_) => return None,
            };
            let (home, place) = self.module(at, parents)?;
            self.declaration(home, &place, last)
        })
    }
}

fn parsed(folder: &Path, name: &str) -> File {
    let files = [folder.join(format!("{name}.rs")), folder.join(name).join("mod.rs")];
    let file: &PathBuf =
        files.iter().find(|file| file.exists()).unwrap_or_else(|| panic!("no {files:?}"));
    let text = std::fs::read_to_string(file).expect("a source file");
    syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// Returns the public interface of the package whose sources are in a folder.
fn interface(folder: &str, name: &str) -> String {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("src");
    let mut read = Crate::default();
    read.root = read.read(parsed(&source, "lib").items, &source);
    let mut listed = BTreeMap::new();
    read.list(&[], name, &mut listed);
    let mut text = String::new();
    let mut homes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, (home, items)) in listed {
        let name = path.rsplit("::").next().expect("a name").to_owned();
        let is_type =
            |item: &Item| matches!(item, Item::Struct(_) | Item::Enum(_) | Item::Trait(_));
        let mut shown = items;
        if shown.iter().any(is_type) {
            homes.entry(name.clone()).or_default().insert(home);
            let impls = read.impls.get(&name).cloned().unwrap_or_default();
            shown.extend(impls.into_iter().map(Item::Impl));
        }
        let file = File { shebang: None, frontmatter: None, attrs: Vec::new(), items: shown };
        text.push_str(&format!("// {path}\n{}\n", prettyplease::unparse(&file)));
    }
    let shared: Vec<_> = homes.iter().filter(|(_, homes)| homes.len() > 1).collect();
    assert!(shared.is_empty(), "public types of {folder} share a name: {shared:?}");
    text
}

#[test]
fn the_public_interfaces_are_as_kept() {
    for (folder, name) in [
        ("runtime", "touchoff"),
        ("haptics", "touchoff_haptics"),
        ("postures", "touchoff_postures"),
        ("verify", "touchoff_verify"),
        ("import", "touchoff_import"),
    ] {
        insta::assert_snapshot!(name, interface(folder, name));
    }
}
