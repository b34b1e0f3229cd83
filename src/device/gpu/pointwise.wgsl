// Functions of single values, and of values at the same place in two matrices.

struct Params {
    // Values there are.
    count: u32,
    cols: u32,
    weight: f32,
}

@group(0) @binding(0) var<uniform> p: Params;
@group(0) @binding(1) var<storage, read> a: array<f32>;
// Of the shape of a; for diffuse λ, one per row.
@group(0) @binding(2) var<storage, read> b: array<f32>;
// For diffuse, one per column.
@group(0) @binding(3) var<storage, read> log_times: array<f32>;
@group(0) @binding(4) var<storage, read_write> out: array<f32>;

fn place(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> u32 {
    return (group.y * groups.x + group.x) * 256u + lane;
}

@compute @workgroup_size(256)
fn multiply(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = place(group, groups, lane);
    if (i < p.count) {
        out[i] = a[i] * b[i];
    }
}

@compute @workgroup_size(256)
fn add(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = place(group, groups, lane);
    if (i < p.count) {
        out[i] = a[i] + p.weight * b[i];
    }
}

@compute @workgroup_size(256)
fn relu(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = place(group, groups, lane);
    if (i < p.count) {
        out[i] = max(a[i], 0.0);
    }
}

// As on the CPU, because the built-in one overflows on some drivers and loses digits near 0 on others.
@compute @workgroup_size(256)
fn hyperbolic_tangent(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = place(group, groups, lane);
    if (i < p.count) {
        let v = a[i];
        let double = 2.0 * min(abs(v), 9.1);
        let half = 0.5 * double;
        let square = half * half;
        let near = half * (1.0 - square * (1.0 / 3.0 - square * (2.0 / 15.0)));
        let far = 1.0 - 2.0 / (exp(double) + 1.0);
        let size = select(far, near, double < 0.1);
        out[i] = select(size, -size, v < 0.0);
    }
}

// (k, c) times exp(−λ_i t_c).
@compute @workgroup_size(256)
fn diffuse(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = place(group, groups, lane);
    if (i < p.count) {
        out[i] = a[i] * exp(-b[i / p.cols] * exp(log_times[i % p.cols]));
    }
}
