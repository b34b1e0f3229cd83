//! Colours of places in a body's upright box, and the numbers that files want them as.

use std::f64::consts::TAU;

use crate::shape::Axis;

/// Linear RGB, each channel in [0, 1].
pub type LinearRgb = [f64; 3];

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

pub(crate) fn from_srgb_byte(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}
