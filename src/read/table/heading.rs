//! Which headings of a table name x, y and z, whatever they are decorated with: `X [mm]`, `pos_x`, `x coord`, `Points:0`, `POINT_X`, `xpos`,
//! `Easting`.

use std::collections::BTreeMap;

/// What a line of headings says about coordinates.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Naming {
    /// The columns of x, y and z.
    Axes([usize; 3]),
    /// Several triples, none of which is more of a position than the others.
    Several,
    None,
}

/// Words that say a triple is where a point lies.
const POSITIONS: [&str; 24] = [
    "pos",
    "position",
    "positions",
    "coord",
    "coords",
    "coordinate",
    "coordinates",
    "co",
    "point",
    "points",
    "pt",
    "loc",
    "location",
    "vertex",
    "vertices",
    "vert",
    "xyz",
    "world",
    "global",
    "cartesian",
    "axis",
    "map",
    "center",
    "centre",
];

/// Words that say it is something else.
const OTHERS: [&str; 52] = [
    "n",
    "nrm",
    "norm",
    "normal",
    "normals",
    "v",
    "vel",
    "velocity",
    "a",
    "acc",
    "acceleration",
    "g",
    "grad",
    "gradient",
    "d",
    "dir",
    "direction",
    "rot",
    "rotation",
    "euler",
    "quat",
    "quaternion",
    "q",
    "o",
    "or",
    "orient",
    "orientation",
    "s",
    "scale",
    "size",
    "c",
    "col",
    "color",
    "colour",
    "rgb",
    "uv",
    "tex",
    "texture",
    "tan",
    "tangent",
    "tangents",
    "binormal",
    "f",
    "force",
    "err",
    "error",
    "std",
    "sigma",
    "var",
    "cov",
    "res",
    "residual",
];

/// Headings of single columns that are no coordinates.
const SINGLES: [&str; 33] = [
    "r",
    "g",
    "b",
    "a",
    "red",
    "green",
    "blue",
    "alpha",
    "rgb",
    "rgba",
    "i",
    "intensity",
    "reflectance",
    "nx",
    "ny",
    "nz",
    "u",
    "lat",
    "lon",
    "lng",
    "latitude",
    "longitude",
    "id",
    "index",
    "idx",
    "frame",
    "time",
    "timestamp",
    "label",
    "class",
    "confidence",
    "curvature",
    "scalar",
];

/// Units, which say nothing of an axis.
const UNITS: [&str; 20] = [
    "mm",
    "cm",
    "m",
    "dm",
    "km",
    "um",
    "in",
    "inch",
    "inches",
    "ft",
    "feet",
    "foot",
    "meter",
    "meters",
    "metre",
    "metres",
    "millimeter",
    "millimeters",
    "millimetre",
    "millimetres",
];

/// Words of surveyors for x, y and z.
const SURVEY: [&[&str]; 3] = [
    &["easting", "east", "eastings"],
    &["northing", "north", "northings"],
    &["elevation", "elev", "height", "altitude", "up", "z"],
];

/// A heading as an axis of a triple: the triple's other words, whether the axis is a digit, and the axis.
type Reading = (String, bool, usize);

/// The columns that `headings` name.
pub(super) fn axes(headings: &[String]) -> Naming {
    let mut triples: BTreeMap<(String, bool), Vec<(usize, usize)>> = BTreeMap::new();
    for (column, heading) in headings.iter().enumerate() {
        for (words, digit, axis) in readings(heading) {
            triples.entry((words, digit)).or_default().push((axis, column));
        }
    }
    let mut found: Vec<(usize, [Vec<usize>; 3])> = Vec::new();
    for ((words, digit), members) in &triples {
        let Some(rank) = rank(words, *digit) else { continue };
        let first = if *digit && !members.iter().any(|(axis, _)| *axis == 0) { 1 } else { 0 };
        if *digit && members.iter().any(|(axis, _)| !(first..first + 3).contains(axis)) {
            continue;
        }
        let columns = [0, 1, 2]
            .map(|a| members.iter().filter(|(axis, _)| *axis == a + first).map(|(_, c)| *c).collect::<Vec<_>>());
        if columns.iter().all(|c| !c.is_empty()) {
            found.push((rank, columns));
        }
    }
    let Some(best) = found.iter().map(|(rank, _)| *rank).min() else { return Naming::None };
    let mut best = found.iter().filter(|(rank, _)| *rank == best);
    match (best.next(), best.next()) {
        (Some((_, columns)), None) if columns.iter().all(|c| c.len() == 1) => {
            Naming::Axes([columns[0][0], columns[1][0], columns[2][0]])
        }
        _ => Naming::Several,
    }
}

/// Whether a heading is certainly not that of a coordinate.
pub(super) fn is_other(heading: &str) -> bool {
    let words = words(heading);
    words.iter().any(|word| SINGLES.contains(&word.as_str()))
        || readings(heading).iter().any(|(rest, ..)| rest.split(' ').any(|word| OTHERS.contains(&word)))
}

/// 0 where nothing but the axis is named, 1 for words of position, 2 for words that nobody knows.
fn rank(words: &str, digit: bool) -> Option<usize> {
    let mut parts = words.split(' ').filter(|word| !word.is_empty()).peekable();
    if parts.peek().is_none() {
        return (!digit).then_some(0);
    }
    if parts.clone().any(|word| OTHERS.contains(&word)) {
        return None;
    }
    match parts.all(|word| POSITIONS.contains(&word)) {
        true => Some(1),
        false => (!digit).then_some(2),
    }
}

fn readings(heading: &str) -> Vec<Reading> {
    let words = words(heading);
    let letter = |word: &str| ["x", "y", "z"].iter().position(|axis| *axis == word);
    let without = |at: usize| {
        let rest: Vec<&str> = words.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, w)| w.as_str()).collect();
        rest.join(" ")
    };
    let letters: Vec<(usize, usize)> = words.iter().enumerate().filter_map(|(k, w)| Some((k, letter(w)?))).collect();
    if let [(at, axis)] = letters[..] {
        let survey = words.len() == 1 && axis == 2;
        let also = survey.then(|| ("map".to_owned(), false, 2));
        return [(without(at), false, axis)].into_iter().chain(also).collect();
    }
    if !letters.is_empty() {
        return Vec::new();
    }
    if let Some(axis) = SURVEY.iter().position(|names| words.len() == 1 && names.contains(&words[0].as_str())) {
        return vec![("map".to_owned(), false, axis)];
    }
    let digit = |word: &str| word.parse::<usize>().ok().filter(|_| word.len() == 1);
    if let Some(axis) = words.last().and_then(|word| digit(word)) {
        return vec![(without(words.len() - 1), true, axis)];
    }
    // An axis without a gap before or behind it.
    let mut glued = Vec::new();
    let (Some(first), Some(last)) = (words.first(), words.last()) else { return glued };
    if let Some((at, axis)) = last.char_indices().next_back().and_then(|(at, c)| Some((at, letter(&c.to_string())?))) {
        let before = words[..words.len() - 1].iter().map(String::as_str);
        glued.push((before.chain([&last[..at]]).collect::<Vec<_>>().join(" "), false, axis));
    }
    if let Some(axis) = first.get(..1).and_then(letter) {
        let after = words[1..].iter().map(String::as_str);
        glued.push(([&first[1..]].into_iter().chain(after).collect::<Vec<_>>().join(" "), false, axis));
    }
    glued
}

/// The words of a heading in lower case, without units. `posX` is two words; what stands in brackets is a unit, unless it is an axis.
fn words(heading: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    let mut unit: Option<String> = None;
    for c in heading.chars() {
        match (&mut unit, c) {
            (None, '[' | '(' | '{' | '<') => unit = Some(String::new()),
            (Some(inside), ']' | ')' | '}' | '>') => {
                let inside = inside.trim().to_lowercase();
                if inside.len() == 1 && "xyz0123".contains(&inside) {
                    words.push(inside);
                }
                words.push(String::new());
                unit = None;
            }
            (Some(inside), c) => inside.push(c),
            (None, c) if !c.is_alphanumeric() => words.push(String::new()),
            (None, c) => {
                if c.is_uppercase() && before.is_lowercase() {
                    words.push(String::new());
                }
                words.last_mut().expect("never empty").extend(c.to_lowercase());
            }
        }
        before = c;
    }
    words.retain(|word| !word.is_empty());
    let units = words.iter().filter(|word| UNITS.contains(&word.as_str())).count();
    if units < words.len() {
        words.retain(|word| !UNITS.contains(&word.as_str()));
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_found_under_what_programs_call_them() {
        let named = |line: &str| axes(&line.split(',').map(str::to_owned).collect::<Vec<_>>());
        for (line, columns) in [
            ("x,y,z", [0, 1, 2]),
            ("id,X [mm],Y [mm],Z [mm]", [1, 2, 3]),
            ("X(m),Y(m),Z(m)", [0, 1, 2]),
            ("x_mm,y_mm,z_mm", [0, 1, 2]),
            ("x coord, y coord, z coord, scalar", [0, 1, 2]),
            ("frame,pos_x,pos_y,pos_z", [1, 2, 3]),
            ("Normals:0,Normals:1,Normals:2,Points:0,Points:1,Points:2", [3, 4, 5]),
            ("Points_1,Points_2,Points_3", [0, 1, 2]),
            ("points[0],points[1],points[2]", [0, 1, 2]),
            ("nx,ny,nz,x,y,z", [3, 4, 5]),
            ("NormalX,NormalY,NormalZ,PositionX,PositionY,PositionZ", [3, 4, 5]),
            ("xpos,ypos,zpos,xnormal,ynormal,znormal", [0, 1, 2]),
            ("OBJECTID,POINT_X,POINT_Y,POINT_Z", [1, 2, 3]),
            ("Northing,Easting,Elevation", [1, 0, 2]),
            ("px,py,pz", [0, 1, 2]),
            ("vx,vy,vz,x,y,z", [3, 4, 5]),
            ("nose x,nose y,nose z", [0, 1, 2]),
            ("id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID", [1, 2, 3]),
            ("coordinates(x),coordinates(y),coordinates(z)", [0, 1, 2]),
        ] {
            assert_eq!(named(line), Naming::Axes(columns), "{line}");
        }
        for line in ["nose_x,nose_y,nose_z,ear_x,ear_y,ear_z", "x,y,z,x,y,z"] {
            assert_eq!(named(line), Naming::Several, "{line}");
        }
        for line in ["a,b,c", "nx,ny,nz", "lat,lon,alt", "r,g,b", "x,y", "Normals:0,Normals:1,Normals:2", "0,1,2", ""] {
            assert_eq!(named(line), Naming::None, "{line}");
        }
    }
}
