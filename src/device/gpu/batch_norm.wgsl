// Columns shifted by a mean and divided by the root of a variance, then times a gain plus a bias.

struct Params {
    // Values there are.
    count: u32,
    cols: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
@group(0) @binding(1) var<storage, read> x: array<f32>;
// One per column each.
@group(0) @binding(2) var<storage, read> mean: array<f32>;
@group(0) @binding(3) var<storage, read> variance: array<f32>;
@group(0) @binding(4) var<storage, read> gain: array<f32>;
@group(0) @binding(5) var<storage, read> bias: array<f32>;
@group(0) @binding(6) var<storage, read_write> out: array<f32>;

// As on the CPU.
const EPSILON = 1e-5;

@compute @workgroup_size(256)
fn batch_norm(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 256u + lane;
    if (i < p.count) {
        let c = i % p.cols;
        let scale = 1.0 / sqrt(variance[c] + EPSILON);
        out[i] = (x[i] - mean[c]) * scale * gain[c] + bias[c];
    }
}
