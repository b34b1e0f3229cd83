// c = a b + bias. A workgroup of 16 × 16 makes a tile of 64 × 64 of c, each invocation 4 × 4 of it, from slices of 16 of the inner index that all of them
// read into workgroup memory. Layers in z take chunks of a long inner index; `sum` adds what they found.

struct Params {
    // Of c.
    rows: u32,
    cols: u32,
    inner: u32,
    // Of c, in this dispatch.
    first_row: u32,
    // Inner indices per layer.
    chunk: u32,
    layers: u32,
    has_bias: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
// (rows, inner), or when transposed (inner, rows); for `sum` the layers (layers, rows, cols).
@group(0) @binding(1) var<storage, read> a: array<f32>;
// (inner, cols), or when transposed (cols, inner).
@group(0) @binding(2) var<storage, read> b: array<f32>;
@group(0) @binding(3) var<storage, read> bias: array<f32>;
@group(0) @binding(4) var<storage, read_write> c: array<f32>;

override transposed_a: bool = false;
override transposed_b: bool = false;

const TILE = 64u;
const SLICE = 16u;
// Vectors of four per inner index, and one that keeps the banks of workgroup memory apart.
const STRIDE = 17u;

var<workgroup> slice_a: array<vec4<f32>, 272>;
var<workgroup> slice_b: array<vec4<f32>, 272>;

fn at_a(row: u32, k: u32, end: u32) -> f32 {
    if (row >= p.rows || k >= end) {
        return 0.0;
    }
    return a[select(row * p.inner + k, k * p.rows + row, transposed_a)];
}

fn at_b(k: u32, col: u32, end: u32) -> f32 {
    if (col >= p.cols || k >= end) {
        return 0.0;
    }
    return b[select(k * p.cols + col, col * p.inner + k, transposed_b)];
}

fn write(row: u32, col: u32, layer: u32, sum: f32) {
    if (row < p.rows && col < p.cols) {
        var value = sum;
        if (p.has_bias != 0u) {
            value += bias[col];
        }
        c[(layer * p.rows + row) * p.cols + col] = value;
    }
}

fn write_four(row: u32, col: u32, layer: u32, sums: vec4<f32>) {
    write(row, col, layer, sums.x);
    write(row, col + 1u, layer, sums.y);
    write(row, col + 2u, layer, sums.z);
    write(row, col + 3u, layer, sums.w);
}

@compute @workgroup_size(256)
fn matmul(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let row = p.first_row + group.y * TILE;
    let col = group.x * TILE;
    let begin = group.z * p.chunk;
    let end = min(begin + p.chunk, p.inner);
    // Neighbouring lanes read neighbouring values, whichever way the matrix lies.
    let k_a = select(lane % SLICE, lane / SLICE, transposed_a);
    let four_a = select(lane / SLICE, lane % SLICE, transposed_a);
    let k_b = select(lane / SLICE, lane % SLICE, transposed_b);
    let four_b = select(lane % SLICE, lane / SLICE, transposed_b);
    let x = lane % 16u;
    let y = lane / 16u;
    var sums_0 = vec4<f32>();
    var sums_1 = vec4<f32>();
    var sums_2 = vec4<f32>();
    var sums_3 = vec4<f32>();
    for (var first = begin; first < end; first += SLICE) {
        let r = row + 4u * four_a;
        let k = first + k_a;
        slice_a[k_a * STRIDE + four_a] =
            vec4(at_a(r, k, end), at_a(r + 1u, k, end), at_a(r + 2u, k, end), at_a(r + 3u, k, end));
        let s = col + 4u * four_b;
        let l = first + k_b;
        slice_b[k_b * STRIDE + four_b] =
            vec4(at_b(l, s, end), at_b(l, s + 1u, end), at_b(l, s + 2u, end), at_b(l, s + 3u, end));
        workgroupBarrier();
        for (var i = 0u; i < SLICE; i++) {
            let left = slice_a[i * STRIDE + y];
            let right = slice_b[i * STRIDE + x];
            sums_0 += left.x * right;
            sums_1 += left.y * right;
            sums_2 += left.z * right;
            sums_3 += left.w * right;
        }
        workgroupBarrier();
    }
    let r = row + 4u * y;
    let s = col + 4u * x;
    write_four(r, s, group.z, sums_0);
    write_four(r + 1u, s, group.z, sums_1);
    write_four(r + 2u, s, group.z, sums_2);
    write_four(r + 3u, s, group.z, sums_3);
}

@compute @workgroup_size(256)
fn sum(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 256u + lane;
    let count = p.rows * p.cols;
    if (i >= count) {
        return;
    }
    var total = 0.0;
    for (var layer = 0u; layer < p.layers; layer++) {
        total += a[layer * count + i];
    }
    c[i] = total;
}
