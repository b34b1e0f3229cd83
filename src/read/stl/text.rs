//! Text STL: `solid`, `facet normal`, `outer loop`, `vertex`, `endloop`, `endfacet`, `endsolid`. A stream of words, whatever lines they
//! stand in, in any case; some writers put a blank behind `end`, or none behind `endsolid`. Several solids are joined.

use super::binary::STL;
use crate::read::draft::Draft;
use crate::read::error::{Place, ReadError, quoted};
use crate::read::polygons::Polygons;
use crate::read::text::{Line, Lines, number};
use crate::shape::{Repair, counted};

pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut words = Words::of(bytes);
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut polygons = Polygons::new(STL, 0);
    let mut corners: Vec<i64> = Vec::new();
    let mut open = true;
    let mut left = 0;
    while let Some(word) = words.next() {
        let line = words.line;
        let keyword = Keyword::of(word, &mut words);
        match keyword {
            Keyword::Vertex => {
                corners.push(points.len() as i64);
                points.push(vertex(&mut words, &polygons)?);
                continue;
            }
            Keyword::EndLoop => {
                polygons.push(&corners, Place::Line(line.number));
                corners.clear();
                continue;
            }
            Keyword::Solid { begins_line } => {
                words.pass_over_name();
                open |= begins_line;
            }
            Keyword::Facet => {
                words.pass_over_normal();
                open = true;
            }
            Keyword::EndSolid => {
                words.pass_over_name();
                open = false;
            }
            Keyword::Between => {}
            Keyword::Other if !open => {
                words.pass_over_line();
                left += 1;
            }
            Keyword::Other => {
                if words.at_end() {
                    return Err(unfinished(&polygons, line.number));
                }
                let problem = format!("“{}” is not a line a text STL can have", quoted(line.bytes.trim_ascii()));
                return Err(ReadError::Malformed { format: STL, problem, at: Place::Line(line.number) });
            }
        }
        if !corners.is_empty() {
            let problem = format!("“{}” stands where vertex or endloop must", quoted(line.bytes.trim_ascii()));
            return Err(ReadError::Malformed { format: STL, problem, at: Place::Line(line.number) });
        }
    }
    if open || !corners.is_empty() {
        return Err(unfinished(&polygons, words.lines.number()));
    }
    if points.is_empty() {
        return Err(ReadError::MissingElement { format: STL, what: "facet with vertices".to_owned() });
    }
    let (faces, mut repairs) = polygons.finish(points.len())?;
    repairs.extend(Repair::counted("trailing-data", left, || {
        format!("{} after the last solid of this STL not read", counted(left, "line", "lines"))
    }));
    Ok(Draft { points, faces, labels: None, repairs })
}

/// What a word is.
enum Keyword {
    Solid {
        begins_line: bool,
    },
    Facet,
    Vertex,
    EndLoop,
    EndSolid,
    /// `outer`, `loop` or `endfacet`: they carry nothing.
    Between,
    Other,
}

impl Keyword {
    /// The keyword that `word`, just taken from `words`, begins; `end` takes the next word along.
    fn of(word: &[u8], words: &mut Words) -> Self {
        let is = |name: &str| word.eq_ignore_ascii_case(name.as_bytes());
        if is("vertex") {
            return Self::Vertex;
        }
        let begins = |name: &str| word.get(..name.len()).is_some_and(|w| w.eq_ignore_ascii_case(name.as_bytes()));
        if is("end") {
            let known = [("loop", Self::EndLoop), ("facet", Self::Between), ("solid", Self::EndSolid)];
            for (name, keyword) in known {
                if words.peek().is_some_and(|next| next.eq_ignore_ascii_case(name.as_bytes())) {
                    words.next();
                    return keyword;
                }
            }
            return Self::Other;
        }
        if is("endloop") {
            Self::EndLoop
        } else if is("facet") || is("facetnormal") {
            Self::Facet
        } else if is("outer") || is("loop") || is("outerloop") || is("endfacet") {
            Self::Between
        } else if begins("endsolid") {
            Self::EndSolid
        } else if is("solid") || begins("solid") && words.seen == 1 {
            Self::Solid { begins_line: words.begins_line }
        } else {
            Self::Other
        }
    }
}

/// The words of a file with their lines.
struct Words<'a> {
    lines: Lines<'a>,
    line: Line<'a>,
    rest: &'a [u8],
    /// Whether the last word was the first of its line.
    begins_line: bool,
    /// Words so far.
    seen: usize,
}

impl<'a> Words<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        let lines = Lines::new(bytes, 1);
        Self { lines, line: Line { number: 0, bytes: b"" }, rest: b"", begins_line: false, seen: 0 }
    }

    /// The next word, in this line or a later one. What `#` begins is a comment.
    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let next = self.next_in_line();
            if next.is_some_and(|word| !word.starts_with(b"#")) {
                return next;
            }
            self.line = self.lines.next()?;
            self.rest = self.line.bytes;
            self.begins_line = true;
        }
    }

    fn next_in_line(&mut self) -> Option<&'a [u8]> {
        let (word, rest) = split_word(self.rest)?;
        self.begins_line = self.rest.len() == self.line.bytes.len();
        self.rest = rest;
        self.seen += 1;
        Some(word)
    }

    /// The next word of this line, or the first of the next.
    fn peek(&self) -> Option<&'a [u8]> {
        split_word(self.rest).map(|(word, _)| word).or_else(|| self.lines.clone().next()?.words().next())
    }

    fn at_end(&self) -> bool {
        self.rest.trim_ascii_start().is_empty() && self.lines.at_end()
    }

    fn pass_over_line(&mut self) {
        self.rest = b"";
    }

    /// A name ends with its line, or before a facet or the end of the solid.
    fn pass_over_name(&mut self) {
        while let Some((word, rest)) = split_word(self.rest) {
            let lower = word.to_ascii_lowercase();
            let next = split_word(rest).map(|(next, _)| next.to_ascii_lowercase()).unwrap_or_default();
            let ends = match lower.as_slice() {
                b"facet" => next == b"normal" || next == b"outer",
                b"end" => next == b"solid",
                b"solid" | b"facetnormal" => true,
                word => word.starts_with(b"endsolid"),
            };
            if ends {
                return;
            }
            self.rest = rest;
        }
    }

    /// `normal` and its three numbers, whatever they are: nothing here needs them.
    fn pass_over_normal(&mut self) {
        let mut taken = 0;
        while let Some(word) = self.peek() {
            let part = word.eq_ignore_ascii_case(b"normal") || number(word).is_some() || word.contains(&b',');
            if !part || taken == 4 {
                return;
            }
            taken += 1;
            self.next();
        }
    }
}

fn split_word(line: &[u8]) -> Option<(&[u8], &[u8])> {
    let line = line.trim_ascii_start();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (end > 0).then(|| line.split_at(end))
}

/// Three numbers; a fourth in the same line is passed over.
fn vertex(words: &mut Words, polygons: &Polygons) -> Result<[f64; 3], ReadError> {
    let at = Place::Line(words.line.number);
    let mut point = [0.0; 3];
    for (found, coordinate) in point.iter_mut().enumerate() {
        let Some(word) = words.peek() else {
            return Err(unfinished(polygons, words.lines.number()));
        };
        if ["vertex", "endloop", "end"].iter().any(|k| word.eq_ignore_ascii_case(k.as_bytes())) {
            let what = "a vertex".to_owned();
            return Err(ReadError::ShortLine { format: STL, what, needed: 3, found: found as u64, at });
        }
        words.next();
        let bad = || ReadError::BadNumber { format: STL, text: quoted(word), expected: "a number", at: at.clone() };
        *coordinate = number(word).ok_or_else(bad)?;
    }
    while split_word(words.rest).is_some_and(|(word, _)| number(word).is_some()) {
        words.next_in_line();
    }
    Ok(point)
}

/// A text STL has no counts; that it is whole shows in its last word.
fn unfinished(polygons: &Polygons, line: usize) -> ReadError {
    let what = counted(polygons.seen(), "facet", "facets");
    let at = Place::Line(line);
    ReadError::Unfinished { format: STL, what, missing: "endsolid", found: polygons.seen() as u64, at }
}
