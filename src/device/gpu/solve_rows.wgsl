// Many small positive definite systems that differ in their diagonal: a workgroup for each, Cholesky column by column in storage memory, and one step of
// iterative refinement.

struct Params {
    // Systems.
    rows: u32,
    // Unknowns.
    width: u32,
    first_row: u32,
    // The bits of a NaN.
    nothing: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
// (width, width).
@group(0) @binding(1) var<storage, read> gram: array<f32>;
// (rows, width) each.
@group(0) @binding(2) var<storage, read> right: array<f32>;
@group(0) @binding(3) var<storage, read> mask: array<f32>;
// Per system of this dispatch: the factor by columns (width, width), and below it a vector.
@group(0) @binding(4) var<storage, read_write> work: array<f32>;
// (rows, width).
@group(0) @binding(5) var<storage, read_write> out: array<f32>;

const LANES = 128u;
// As on the CPU.
const RIDGE = 1e-6;

var<workgroup> ridge: f32;
// 1 while every pivot was positive.
var<workgroup> sound: u32;

// Solves L Lᵀ z = z for the vector at `vector` with the factor at `factor`.
fn substitute(factor: u32, vector: u32, lane: u32) {
    let k = p.width;
    for (var j = 0u; j < k; j++) {
        let z = work[vector + j] / work[factor + j * k + j];
        storageBarrier();
        workgroupBarrier();
        for (var i = j + 1u + lane; i < k; i += LANES) {
            work[vector + i] -= work[factor + j * k + i] * z;
        }
        if (lane == 0u) {
            work[vector + j] = z;
        }
        storageBarrier();
        workgroupBarrier();
    }
    for (var step = 0u; step < k; step++) {
        let j = k - 1u - step;
        let z = work[vector + j] / work[factor + j * k + j];
        storageBarrier();
        workgroupBarrier();
        for (var i = lane; i < j; i += LANES) {
            work[vector + i] -= work[factor + i * k + j] * z;
        }
        if (lane == 0u) {
            work[vector + j] = z;
        }
        storageBarrier();
        workgroupBarrier();
    }
}

@compute @workgroup_size(128)
fn solve_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = p.width;
    let row = p.first_row + group.x;
    let own = row * k;
    let factor = group.x * (k + 1u) * k;
    let vector = factor + k * k;
    if (lane == 0u) {
        var trace = 0.0;
        for (var i = 0u; i < k; i++) {
            trace += gram[i * k + i];
        }
        ridge = RIDGE * trace / f32(k);
        sound = 1u;
    }
    workgroupBarrier();
    for (var j = 0u; j < k; j++) {
        // Column j less what earlier columns explain.
        for (var i = j + lane; i < k; i += LANES) {
            var sum = gram[j * k + i];
            if (i == j) {
                sum += mask[own + j] + ridge;
            }
            for (var t = 0u; t < j; t++) {
                sum -= work[factor + t * k + i] * work[factor + t * k + j];
            }
            work[factor + j * k + i] = sum;
        }
        storageBarrier();
        workgroupBarrier();
        let pivot = work[factor + j * k + j];
        let positive = pivot > 0.0;
        let root = sqrt(select(1.0, pivot, positive));
        storageBarrier();
        workgroupBarrier();
        for (var i = j + lane; i < k; i += LANES) {
            let place = factor + j * k + i;
            work[place] = select(work[place] / root, root, i == j);
        }
        if (lane == 0u && !positive) {
            sound = 0u;
        }
        storageBarrier();
        workgroupBarrier();
    }

    for (var i = lane; i < k; i += LANES) {
        work[vector + i] = right[own + i];
    }
    storageBarrier();
    workgroupBarrier();
    substitute(factor, vector, lane);
    for (var i = lane; i < k; i += LANES) {
        out[own + i] = work[vector + i];
    }
    storageBarrier();
    workgroupBarrier();
    // What the solution leaves, solved for again.
    for (var i = lane; i < k; i += LANES) {
        var rest = right[own + i];
        for (var t = 0u; t < k; t++) {
            rest -= gram[t * k + i] * out[own + t];
        }
        work[vector + i] = rest - (mask[own + i] + ridge) * out[own + i];
    }
    storageBarrier();
    workgroupBarrier();
    substitute(factor, vector, lane);
    for (var i = lane; i < k; i += LANES) {
        let solved = out[own + i] + work[vector + i];
        // Where there is no solution, that is said.
        out[own + i] = bitcast<f32>(select(p.nothing, bitcast<u32>(solved), sound == 1u));
    }
}
