//! What each shader's `struct Params` holds: the two are compared with naga's eyes in `tests/shaders.rs`, which includes this file.

/// What a dispatch tells its shader.
pub trait Params: Copy {
    /// Bytes of it.
    const SIZE: usize;
    /// Its fields one after the other, as a shader lays out 32-bit numbers.
    fn bytes(&self) -> Vec<u8>;
}

/// Declares structs of 32-bit numbers, and tells their fields by the name of the shader.
macro_rules! params {
    ($($(#[$doc:meta])* $name:ident for $shader:literal { $($field:ident: $number:ident),* $(,)? })*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub struct $name {
                $(pub $field: $number),*
            }

            impl Params for $name {
                const SIZE: usize = 0 $(+ size_of::<$number>())*;

                fn bytes(&self) -> Vec<u8> {
                    [$(self.$field.to_le_bytes()),*].concat()
                }
            }
        )*

        /// Shader, and name and type of each field.
        #[cfg(test)]
        #[allow(dead_code)] // For `tests/shaders.rs` alone.
        pub const LAYOUTS: &[(&str, &[(&str, &str)])] =
            &[$(($shader, &[$((stringify!($field), stringify!($number))),*])),*];
    };
}

params! {
    /// Of a product of matrices.
    Matmul for "matmul" { rows: u32, cols: u32, inner: u32, first_row: u32, chunk: u32, layers: u32, has_bias: u32 }
    /// Of work on one row at a time.
    Rows for "rows" { rows: u32, cols: u32 }
    /// Of work on one column at a time.
    BatchNorm for "batch_norm" { count: u32, cols: u32 }
    /// Of functions of single values.
    Pointwise for "pointwise" { count: u32, cols: u32, weight: f32 }
    /// Of copies.
    Columns for "columns" { count: u32, cols: u32, from_cols: u32, to_cols: u32, to_first: u32, weight: f32 }
    /// Of cross products.
    CrossPairs for "cross_pairs" { rows: u32 }
    /// Of attention.
    Attention for "attention" {
        queries: u32, keys: u32, width: u32, parts: u32, values: u32, first_query: u32, scale: f32, hard: u32,
    }
    /// Of the comparison of two matrices' rows.
    NearestRows for "nearest_rows" { rows_x: u32, rows_y: u32, width: u32, first_row: u32, slab: u32 }
    /// Of what tiles of that found.
    NearestMerge for "nearest_merge" { rows: u32, first_row: u32, tiles: u32, continued: u32 }
    /// Of many small systems.
    SolveRows for "solve_rows" { rows: u32, width: u32, first_row: u32, nothing: u32 }
}

/// Which operand lies transposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Transposed {
    Neither,
    Left,
    Right,
}
