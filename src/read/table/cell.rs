//! What a field of a table says: a number, or that there is none.

use crate::read::text::number;

/// What marks the decimals of a file.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Decimal {
    Point,
    Comma,
}

/// What spreadsheets and statistics programs write where a value is missing.
const MISSING: [&str; 13] =
    ["", "na", "n/a", "#n/a", "null", "none", "nil", "missing", "#num!", "#value!", "#div/0!", "#ref!", "#name?"];

/// A number; NaN where a word says that there is none.
pub(super) fn value(field: &[u8], decimal: Decimal) -> Option<f64> {
    let found = match decimal {
        Decimal::Point => number(field),
        Decimal::Comma if field.contains(&b'.') => None,
        Decimal::Comma => {
            let pointed: Vec<u8> = field.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
            number(&pointed)
        }
    };
    found.or_else(|| is_missing(field).then_some(f64::NAN))
}

pub(super) fn is_missing(field: &[u8]) -> bool {
    MISSING.iter().any(|word| field.eq_ignore_ascii_case(word.as_bytes()))
}

/// Whether `#` and what follows it says that a value is missing, so that it begins no comment.
pub(super) fn begins_missing(text: &[u8]) -> bool {
    let marks = MISSING.iter().filter(|word| word.starts_with('#'));
    marks.into_iter().any(|m| text.get(..m.len()).is_some_and(|t| t.eq_ignore_ascii_case(m.as_bytes())))
}

/// `-12,5`: digits around one comma, and whether the comma can be nothing but a decimal mark. Three digits behind it may be thousands,
/// but not where a zero stands before it.
pub(super) fn around_comma(field: &[u8]) -> Option<bool> {
    let digits = field.strip_prefix(b"-").or_else(|| field.strip_prefix(b"+")).unwrap_or(field);
    let at = digits.iter().position(|&b| b == b',')?;
    let (whole, part) = (&digits[..at], &digits[at + 1..]);
    let all_digits = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
    let mantissa = part.iter().position(|b| b"eE".contains(b)).map_or(part, |end| &part[..end]);
    let fits = all_digits(whole) && all_digits(mantissa);
    fits.then(|| mantissa.len() != 3 || whole == b"0")
}
