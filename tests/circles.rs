//! No file of the crate imports from another that imports from it, however far round. Read are `use` lines and paths written out in the code; not seen are
//! methods, names that a glob or the root of the crate hands on, and names that a re-export changes.
#![cfg(not(target_arch = "wasm32"))]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A module by its path in the crate: `pipeline::matching` is `["pipeline", "matching"]`.
type Module = Vec<String>;

/// The code of every module: without comments, and without its tests, which stand last.
#[derive(Default)]
struct Crate(BTreeMap<Module, String>);

/// What the `use` lines of a module name.
struct Uses {
    /// Paths that it uses itself.
    own: Vec<String>,
    /// Paths that it only hands on: whoever asks for them here needs the module where they are.
    handed_on: Vec<String>,
}

impl Crate {
    fn read(folder: &Path, module: &Module, into: &mut Self) {
        for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            let name = entry.file_stem().expect("a name").to_string_lossy().into_owned();
            let inner: Module = module.iter().cloned().chain([name.clone()]).collect();
            if entry.is_dir() {
                Self::read(&entry, &inner, into);
            } else if entry.extension().is_some_and(|extension| extension == "rs") {
                let of = if ["mod", "lib"].contains(&name.as_str()) { module.clone() } else { inner };
                into.add(of, &fs::read_to_string(&entry).expect("text"));
            }
        }
    }

    fn add(&mut self, module: Module, text: &str) {
        let text = text.split("mod tests {").next().unwrap_or_default();
        let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
        self.0.insert(module, code.join("\n"));
    }

    fn is_module(&self, path: &[String]) -> bool {
        path.is_empty() || self.0.contains_key(path)
    }

    /// The module that `path`, written in `from`, leads into, and the name that is wanted there. None of another crate, or of what is no module.
    fn resolve(&self, from: &Module, path: &str) -> Option<(Module, Option<String>)> {
        let mut names = path.split("::").map(str::to_owned).peekable();
        let mut at: Module = match names.peek()?.as_str() {
            "crate" => Vec::new(),
            "super" | "self" => from.clone(),
            child => {
                let inner: Module = from.iter().cloned().chain([child.to_owned()]).collect();
                return self.is_module(&inner).then(|| self.resolve(from, &format!("self::{path}")))?;
            }
        };
        while let Some(name) = names.next_if(|name| ["crate", "super", "self"].contains(&name.as_str())) {
            if name == "super" {
                at.pop();
            }
        }
        while let Some(name) = names.peek() {
            at.push(name.clone());
            if !self.is_module(&at) {
                at.pop();
                break;
            }
            names.next();
        }
        Some((at, names.next()))
    }

    /// Which modules each module uses.
    fn arrows(&self) -> BTreeMap<&Module, BTreeSet<Module>> {
        let uses: BTreeMap<&Module, Uses> = self.0.iter().map(|(module, code)| (module, Uses::of(code))).collect();
        let mut handed_on = BTreeMap::new();
        for (module, uses) in &uses {
            for (to, name) in uses.handed_on.iter().filter_map(|path| self.resolve(module, path)) {
                handed_on.extend(name.map(|name| (((*module).clone(), name), to)));
            }
        }
        let arrows = uses.iter().map(|(&module, uses)| {
            let ends = uses.own.iter().filter_map(|path| self.resolve(module, path)).map(|(mut to, name)| {
                while let Some(next) = name.as_ref().and_then(|name| handed_on.get(&(to.clone(), name.clone()))) {
                    to = next.clone();
                }
                to
            });
            (module, ends.filter(|to| to != module && !to.is_empty()).collect())
        });
        arrows.collect()
    }

    /// A way from a module back to itself, as `a → b → a`, if there is one.
    fn circle(&self) -> Option<String> {
        let mut arrows = self.arrows();
        // What uses nothing that is left lies in no circle.
        loop {
            let done: BTreeSet<Module> =
                arrows.iter().filter(|(_, ends)| ends.is_empty()).map(|(&module, _)| module.clone()).collect();
            if done.is_empty() {
                break;
            }
            arrows.retain(|module, _| !done.contains(*module));
            arrows.values_mut().for_each(|ends| ends.retain(|end| !done.contains(end)));
        }
        let mut way = vec![(*arrows.keys().next()?).clone()];
        loop {
            let next = arrows[way.last().expect("begun")].first().expect("not done").clone();
            let seen = way.iter().position(|module| *module == next);
            way.push(next);
            if let Some(first) = seen {
                return Some(way[first..].iter().map(|module| module.join("::")).collect::<Vec<_>>().join(" → "));
            }
        }
    }
}

impl Uses {
    fn of(code: &str) -> Self {
        let mut found = Uses { own: Vec::new(), handed_on: Vec::new() };
        let mut rest = String::new();
        for statement in code.split_inclusive(';') {
            let begin =
                statement.rfind("\nuse ").or(statement.rfind("\npub use ")).or(statement.rfind("\npub(crate) use "));
            let begin =
                begin.or(["use ", "pub use ", "pub(crate) use "].iter().any(|s| statement.starts_with(s)).then_some(0));
            let Some(begin) = begin else {
                // `mod a;` names no use of a.
                let (before, last) = statement.rsplit_once('\n').unwrap_or(("", statement));
                rest.push_str(if last.starts_with("mod ") || last.contains(" mod ") { before } else { statement });
                continue;
            };
            rest.push_str(&statement[..begin]);
            let line = statement[begin..].trim().trim_end_matches(';');
            let (visible, path) = line.split_once("use ").expect("a use line");
            let paths = if visible.is_empty() { &mut found.own } else { &mut found.handed_on };
            paths.extend(ungrouped(&path.split_whitespace().collect::<Vec<_>>().join(" ")));
        }
        // What is handed on and used as well.
        let words: BTreeSet<&str> = rest.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        let last = |path: &String| path.rsplit("::").next().unwrap_or_default().to_owned();
        found.own.extend(found.handed_on.iter().filter(|path| words.contains(last(path).as_str())).cloned());
        // Paths written out in the code.
        let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        let paths = rest.split(|c: char| !is_path(c)).filter(|word| word.contains("::") && !word.starts_with(':'));
        found.own.extend(paths.map(|word| word.trim_end_matches(':').to_owned()));
        found
    }
}

/// `a::{b, c::{d, e}}` is `a::b`, `a::c::d` and `a::c::e`; other names (`as`) are left out.
fn ungrouped(path: &str) -> Vec<String> {
    let path = path.trim();
    let Some((front, group)) = path.split_once('{') else {
        let path = path.split(" as ").next().unwrap_or_default().trim();
        return if path.is_empty() { Vec::new() } else { vec![path.trim_end_matches("::self").to_owned()] };
    };
    let inner = &group[..group.rfind('}').expect("a group ends")];
    let (mut depth, mut begin, mut found) = (0, 0, Vec::new());
    for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                found.extend(ungrouped(&inner[begin..at]).into_iter().map(|path| format!("{front}{path}")));
                begin = at + 1;
            }
            _ => {}
        }
    }
    found.iter().map(|path| path.trim_end_matches("::self").to_owned()).collect()
}

#[test]
fn no_file_lies_in_a_circle() {
    let mut all = Crate::default();
    Crate::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &Vec::new(), &mut all);
    all.0.retain(|module, _| !module.is_empty() && module[0] != "bin");
    let arrows: usize = all.arrows().values().map(BTreeSet::len).sum();
    assert!(all.0.len() > 200 && arrows > 600, "{} files and {arrows} arrows were looked at", all.0.len());
    assert_eq!(all.circle(), None);
}

#[test]
fn a_circle_is_found_however_it_is_written() {
    let of = |files: &[(&str, &str)]| {
        let mut all = Crate::default();
        files.iter().for_each(|(path, text)| all.add(path.split("::").map(str::to_owned).collect(), text));
        all.circle()
    };
    let found = |files: &[(&str, &str)]| of(files).unwrap_or_default();
    assert_eq!(found(&[("a", "use crate::b::B;"), ("b", "use super::{c::C, a::A as X};"), ("c", "")]), "a → b → a");
    assert_eq!(found(&[("a", "mod c;\nfn f() { c::g() }"), ("a::c", "fn g() { super::f() }")]), "a → a::c → a");
    assert_eq!(
        found(&[("a", "pub use c::g;"), ("a::c", "use crate::b;"), ("b", "use crate::a::g;")]),
        "a::c → b → a::c"
    );
    assert_eq!(found(&[("a", "pub use c::G;\nfn f() -> G {}"), ("a::c", "use super::f;")]), "a → a::c → a");
    // What is only handed on, what tests use, and what comments say makes none.
    assert_eq!(found(&[("a", "pub use c::g;\nfn f() {}"), ("a::c", "use super::f;")]), "");
    assert_eq!(
        found(&[
            ("a", "use crate::b::B; // and crate::b"),
            ("b", "// use crate::a\n\n#[cfg(test)]\nmod tests {\n    use crate::a::A;")
        ]),
        ""
    );
}
