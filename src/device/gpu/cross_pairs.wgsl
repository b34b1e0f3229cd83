// Cross products of all pairs of rows i < j, in lexicographic order. An invocation per (i, j); those with i ≥ j have nothing to do.

struct Params {
    rows: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
// (rows, 3).
@group(0) @binding(1) var<storage, read> g: array<f32>;
// (rows(rows − 1)/2, 3).
@group(0) @binding(2) var<storage, read_write> out: array<f32>;

fn vector(row: u32) -> vec3<f32> {
    return vec3(g[3u * row], g[3u * row + 1u], g[3u * row + 2u]);
}

@compute @workgroup_size(16, 16)
fn cross_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.y;
    let j = id.x;
    if (i >= j || j >= p.rows) {
        return;
    }
    let product = cross(vector(i), vector(j));
    // Pairs of earlier rows first, of which row r begins rows − 1 − r.
    let pair = i * (2u * p.rows - i - 1u) / 2u + j - i - 1u;
    out[3u * pair] = product.x;
    out[3u * pair + 1u] = product.y;
    out[3u * pair + 2u] = product.z;
}
