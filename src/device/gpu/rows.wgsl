// Work on one row at a time: a workgroup per row.

struct Params {
    rows: u32,
    cols: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
// (rows, cols).
@group(0) @binding(1) var<storage, read> x: array<f32>;
// (1, cols) each, for layer_norm only.
@group(0) @binding(2) var<storage, read> gain: array<f32>;
@group(0) @binding(3) var<storage, read> bias: array<f32>;
// (rows, cols); for squares (rows, 1).
@group(0) @binding(4) var<storage, read_write> out: array<f32>;

const LANES = 64u;
// As on the CPU.
const EPSILON = 1e-5;
const SHORTEST = 1e-6;
const LEAST_EXPONENT = -87.0;

var<workgroup> partial: array<f32, LANES>;

// The sum of what every lane brings, in the same order for every row.
fn total(own: f32, lane: u32) -> f32 {
    partial[lane] = own;
    workgroupBarrier();
    for (var half = LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            partial[lane] += partial[lane + half];
        }
        workgroupBarrier();
    }
    let all = partial[0];
    workgroupBarrier();
    return all;
}

// The largest of what every lane brings.
fn most(own: f32, lane: u32) -> f32 {
    partial[lane] = own;
    workgroupBarrier();
    for (var half = LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            partial[lane] = max(partial[lane], partial[lane + half]);
        }
        workgroupBarrier();
    }
    let all = partial[0];
    workgroupBarrier();
    return all;
}

fn sum_of_squares(start: u32, mean: f32, lane: u32) -> f32 {
    var squares = 0.0;
    for (var c = lane; c < p.cols; c += LANES) {
        let v = x[start + c] - mean;
        squares += v * v;
    }
    return total(squares, lane);
}

@compute @workgroup_size(64)
fn layer_norm(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let row = group.y * groups.x + group.x;
    if (row >= p.rows) {
        return;
    }
    let start = row * p.cols;
    var sum = 0.0;
    for (var c = lane; c < p.cols; c += LANES) {
        sum += x[start + c];
    }
    let mean = total(sum, lane) / f32(p.cols);
    let scale = 1.0 / sqrt(sum_of_squares(start, mean, lane) / f32(p.cols) + EPSILON);
    for (var c = lane; c < p.cols; c += LANES) {
        out[start + c] = (x[start + c] - mean) * scale * gain[c] + bias[c];
    }
}

@compute @workgroup_size(64)
fn normalize_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let row = group.y * groups.x + group.x;
    if (row >= p.rows) {
        return;
    }
    let start = row * p.cols;
    let length = max(sqrt(sum_of_squares(start, 0.0, lane)), SHORTEST);
    for (var c = lane; c < p.cols; c += LANES) {
        out[start + c] = x[start + c] / length;
    }
}

@compute @workgroup_size(64)
fn softmax_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let row = group.y * groups.x + group.x;
    if (row >= p.rows) {
        return;
    }
    let start = row * p.cols;
    var largest = x[start];
    for (var c = lane; c < p.cols; c += LANES) {
        largest = max(largest, x[start + c]);
    }
    largest = most(largest, lane);
    var sum = 0.0;
    for (var c = lane; c < p.cols; c += LANES) {
        sum += exp(max(x[start + c] - largest, LEAST_EXPONENT));
    }
    let scale = 1.0 / total(sum, lane);
    for (var c = lane; c < p.cols; c += LANES) {
        out[start + c] = exp(max(x[start + c] - largest, LEAST_EXPONENT)) * scale;
    }
}

// Square of the length of every row.
@compute @workgroup_size(64)
fn squares(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let row = group.y * groups.x + group.x;
    if (row >= p.rows) {
        return;
    }
    let square = sum_of_squares(row * p.cols, 0.0, lane);
    if (lane == 0u) {
        out[row] = square;
    }
}
