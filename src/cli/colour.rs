//! The colours that show which place of B each point of A was matched with: those of the page (`www/src/colour`), so that a file looks
//! like the screen.

use crate::maps::{Correspondence, UNMATCHED};
use crate::pipeline::{Match, PreparedShape};
use crate::write::{LinearRgb, from_srgb_byte, place_colour, upright};

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

/// A colour per point (n), by its place in the body's upright box, which knows nothing of what was set aside.
fn place_colours(body: &PreparedShape) -> Vec<LinearRgb> {
    let points = body.shape.points();
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let aside = body.support.unmatched.as_deref().unwrap_or_default();
    let mut include = |i: u32| {
        if aside.binary_search(&i).is_ok() {
            return;
        }
        let p = points[i as usize];
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    };
    // Points of a mesh that belong to no face are not seen, however far off they lie.
    match body.shape.faces() {
        [] => (0..points.len() as u32).for_each(&mut include),
        faces => faces.iter().flatten().for_each(|&i| include(i)),
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
