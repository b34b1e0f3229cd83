//! The rooms of the crate lie on floors, and no file looks up: every `use crate::…` names a room below its own.

use std::fs;
use std::path::{Path, PathBuf};

/// Rooms from the lowest to the highest. A room may use itself and whatever stands before it.
const FLOORS: [&str; 22] = [
    "vector",
    "progress",
    "graph",
    "shape",
    "read",
    "write",
    "operators",
    "spectrum",
    "descriptors",
    "device",
    "network",
    "maps",
    "confidence",
    "registration",
    "lifting",
    "pipeline",
    "uses",
    "evaluate",
    "train",
    "cli",
    "wasm",
    "bin",
];

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|&known| known == room)
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        match entry.is_dir() {
            true => found.extend(sources(&entry)),
            false if entry.extension().is_some_and(|e| e == "rs") => found.push(entry),
            false => {}
        }
    }
    found.sort();
    found
}

/// Names after `crate::` in the code of a file, also those of a group `crate::{a, b::c}`; not in its comments.
fn rooms_used(text: &str) -> Vec<String> {
    let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
    let mut rooms = Vec::new();
    for (at, _) in code.join("\n").match_indices("crate::") {
        let joined = code.join("\n");
        let rest = &joined[at + "crate::".len()..];
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        match rest.strip_prefix('{') {
            None => rooms.push(rest.chars().take_while(|&c| is_name(c)).collect()),
            Some(group) => {
                let (mut depth, mut name, mut heads) = (1, String::new(), true);
                for c in group.chars() {
                    match c {
                        '{' => depth += 1,
                        '}' => depth -= 1,
                        _ => {}
                    }
                    if depth == 0 {
                        break;
                    }
                    match c {
                        ',' if depth == 1 => heads = true,
                        ':' if depth == 1 => heads = false,
                        _ => {}
                    }
                    if heads && depth == 1 && c.is_whitespace() && !name.is_empty() {
                        // What follows is `as` and another name.
                        heads = false;
                    }
                    if heads && depth == 1 && is_name(c) {
                        name.push(c);
                    } else if !name.is_empty() {
                        rooms.push(std::mem::take(&mut name));
                    }
                }
                rooms.extend((!name.is_empty()).then_some(name));
            }
        }
    }
    rooms
}

/// The same with as many `super::` as lead out of a module that lies `depth` deep into the root, written as `crate::`. Tests, which stand last and lie one deeper, are left out.
fn from_the_root(text: &str, depth: usize) -> String {
    let code = text.split("mod tests {").next().unwrap_or_default();
    code.replace(&"super::".repeat(depth), "crate::")
}

/// The arrows of a file that lead to a higher floor, or to a room that has none.
fn arrows_up(own: &str, text: &str) -> Vec<String> {
    let Some(own) = floor(own) else { return vec![format!("{own} is on no floor")] };
    let above = |room: &String| floor(room).is_none_or(|floor| floor > own);
    rooms_used(text).into_iter().filter(above).collect()
}

#[test]
fn no_file_uses_a_room_above_its_own() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut files, mut up) = (0, Vec::new());
    for file in sources(&src) {
        let within = file.strip_prefix(&src).expect("inside");
        let room = within.components().next().expect("a name").as_os_str().to_string_lossy();
        let room = room.trim_end_matches(".rs").to_owned();
        if room == "lib" {
            continue;
        }
        files += 1;
        let text = fs::read_to_string(&file).expect("text");
        // `mod.rs` is the module of its folder.
        let depth = within.components().count() - usize::from(within.ends_with("mod.rs"));
        let text = format!("{text}\n{}", from_the_root(&text, depth));
        up.extend(arrows_up(&room, &text).into_iter().map(|used| format!("{} uses {used}", within.display())));
    }
    assert!(files > 150, "only {files} files were looked at");
    assert!(up.is_empty(), "{}", up.join("\n"));
}

/// Whoever looks a word up finds the file.
#[test]
fn the_files_that_the_glossary_names_are_there() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let text = fs::read_to_string(src.join("lib.rs")).expect("text");
    let named: Vec<&str> = text.split('`').filter(|name| name.ends_with(".rs") && !name.contains(' ')).collect();
    let missing: Vec<&&str> = named.iter().filter(|name| !src.join(name).is_file()).collect();
    assert!(named.len() > 25 && missing.is_empty(), "{} named, missing {missing:?}", named.len());
}

/// One idea a file. The generator of bodies in the trainer is tables of a body.
#[test]
fn no_file_has_more_than_400_lines() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let length = |file: &PathBuf| fs::read_to_string(file).expect("text").lines().count();
    let long =
        sources(&src).into_iter().filter(|file| !file.starts_with(src.join("train/bodies")) && length(file) > 400);
    assert_eq!(long.collect::<Vec<_>>(), Vec::<PathBuf>::new());
}

#[test]
fn an_arrow_upwards_is_found_however_it_is_written() {
    assert_eq!(arrows_up("graph", "use crate::shape::Shape;\nuse crate::vector::dot;"), ["shape"]);
    assert_eq!(arrows_up("graph", "use crate::{vector::dot, pipeline::{Match, prepare}, maps};"), ["pipeline", "maps"]);
    assert_eq!(
        arrows_up("maps", "fn f() { crate::registration::refine() }\n// crate::cli is fine here"),
        ["registration"]
    );
    assert_eq!(arrows_up("maps", "use crate::Model;"), ["Model"], "the root is above everything");
    assert_eq!(arrows_up("elsewhere", ""), ["elsewhere is on no floor"]);
    assert!(arrows_up("pipeline", "use crate::{graph::components, maps as spectra};").is_empty());
    // From `graph/refine.rs`, and from `graph/mod.rs`.
    for (text, depth) in [("use super::super::shape::Shape;", 2), ("use super::{shape::Shape, vector};", 1)] {
        assert_eq!(arrows_up("graph", &from_the_root(text, depth)), ["shape"]);
    }
    assert!(arrows_up("graph", &from_the_root("use super::components::of;", 2)).is_empty());
}
