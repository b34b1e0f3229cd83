// Rows and columns copied to where they are wanted.

struct Params {
    // Values to copy: rows × cols.
    count: u32,
    cols: u32,
    // Columns of either matrix, and the first one written.
    from_cols: u32,
    to_cols: u32,
    to_first: u32,
    weight: f32,
}

@group(0) @binding(0) var<uniform> p: Params;
@group(0) @binding(1) var<storage, read> source: array<f32>;
// For gather only: the row of the source for each row.
@group(0) @binding(2) var<storage, read> order: array<u32>;
@group(0) @binding(3) var<storage, read_write> out: array<f32>;

// The first columns of the source, times a weight, beside what is there already.
@compute @workgroup_size(256)
fn beside(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 256u + lane;
    if (i < p.count) {
        let row = i / p.cols;
        let col = i % p.cols;
        out[row * p.to_cols + p.to_first + col] = p.weight * source[row * p.from_cols + col];
    }
}

@compute @workgroup_size(256)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 256u + lane;
    if (i < p.count) {
        out[i] = source[order[i / p.cols] * p.cols + i % p.cols];
    }
}
