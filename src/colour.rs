//! The colours that show which place of B each point of A was matched with: those of the page (`www/src/colour`), so that a file looks
//! like the screen.

use std::f64::consts::TAU;

use crate::fmap::{Correspondence, UNMATCHED};
use crate::options::Axis;
use crate::pipeline::Match;
use crate::prepared::PreparedShape;

/// Linear RGB, each channel in [0, 1].
pub type LinearRgb = [f64; 3];

/// Grey, sRGB #8d9096, for points without a match.
const UNKNOWN: [u8; 3] = [0x8d, 0x90, 0x96];

/// Colours for the points of A (n_a) and of B (n_b): B by place, A by the place on B that each of its points was matched with.
pub fn correspondence_colours(matched: &Match, b: &PreparedShape) -> [Vec<LinearRgb>; 2] {
    let places = place_colours(b);
    let unknown = UNKNOWN.map(from_srgb_byte);
    let paint = |map: &Correspondence, place: &dyn Fn(usize, u32) -> usize| {
        let colour = |(i, &target): (usize, &u32)| if target == UNMATCHED { unknown } else { places[place(i, target)] };
        map.target.iter().enumerate().map(colour).collect()
    };
    [paint(&matched.a_to_b, &|_, target| target as usize), paint(&matched.b_to_a, &|j, _| j)]
}

/// A colour per point (n), by its place in the body's upright box.
fn place_colours(body: &PreparedShape) -> Vec<LinearRgb> {
    let points = body.shape.points();
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut include = |p: [f64; 3]| {
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    };
    // Points of a mesh that belong to no face are not seen, however far off they lie.
    match body.shape.faces() {
        [] => points.iter().for_each(|&p| include(p)),
        faces => faces.iter().flatten().for_each(|&i| include(points[i as usize])),
    }
    let turn = upright(body.info.up_axis);
    let share = |p: &[f64; 3]| {
        turn.map(|(axis, sign)| {
            let extent = high[axis] - low[axis];
            let centred = if extent > 0.0 { (p[axis] - low[axis]) / extent - 0.5 } else { 0.0 };
            (0.5 + sign * centred).clamp(0.0, 1.0)
        })
    };
    points.iter().map(|p| place_colour(share(p))).collect()
}

/// Which axis of a scan, and with which sign, is the x, y and z of the same scan standing upright (y up), by its axis that is up. A rotation.
pub(crate) fn upright(up: Option<Axis>) -> [(usize, f64); 3] {
    match up {
        Some(Axis::X) => [(1, -1.0), (0, 1.0), (2, 1.0)],
        Some(Axis::Y) | None => [(0, 1.0), (1, 1.0), (2, 1.0)],
        Some(Axis::Z) => [(0, 1.0), (2, 1.0), (1, -1.0)],
    }
}

/// The colour of a place in a box, each coordinate in [0, 1]. Left to right runs from blue to yellow and bottom to top from dark to light, both of
/// which every kind of colour vision tells apart; back to front adds green to red.
pub fn place_colour([x, y, z]: [f64; 3]) -> LinearRgb {
    let green_red = 0.1 * (TAU * (0.08 + 0.9 * y)).sin() + 0.12 * (z - 0.5);
    from_oklab(0.44 + 0.44 * y, green_red, 0.34 * (x - 0.5))
}

/// Björn Ottosson's OKLab (2020), in which equal steps look equal: lightness in [0, 1], a (green–red) and b (blue–yellow) in about ±0.3.
fn from_oklab(lightness: f64, a: f64, b: f64) -> LinearRgb {
    let l = (lightness + 0.3963377774 * a + 0.2158037573 * b).powi(3);
    let m = (lightness - 0.1055613458 * a - 0.0638541728 * b).powi(3);
    let s = (lightness - 0.0894841775 * a - 1.291485548 * b).powi(3);
    [
        4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
    ]
    .map(|channel| channel.clamp(0.0, 1.0))
}

/// A linear channel as an sRGB byte (IEC 61966-2-1).
pub fn to_srgb_byte(channel: f64) -> u8 {
    let encoded = if channel <= 0.0031308 { channel * 12.92 } else { 1.055 * channel.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

fn from_srgb_byte(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}
