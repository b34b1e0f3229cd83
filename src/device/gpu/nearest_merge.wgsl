// The nearest of what the tiles of nearest_rows found, one invocation per row.

struct Params {
    // Rows at hand, and the place of the first among all.
    rows: u32,
    first_row: u32,
    tiles: u32,
    // Whether the first row of `best` holds what earlier tiles found.
    continued: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
// With labels: index of the row and its label, by place.
@group(0) @binding(1) var<storage, read> order: array<vec2<u32>>;
// Bits of the distance and index of the nearest: (1 + tiles, rows). The first row receives the nearest so far.
@group(0) @binding(2) var<storage, read_write> best: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> out: array<u32>;

override labelled: bool = false;

const NONE = 0xffffffffu;
const FARTHEST = 3.4028234e38;

@compute @workgroup_size(64)
fn nearest_merge(@builtin(global_invocation_id) id: vec3<u32>) {
    let place = id.x;
    if (place >= p.rows) {
        return;
    }
    var distance = FARTHEST;
    var index = NONE;
    for (var tile = select(1u, 0u, p.continued != 0u); tile <= p.tiles; tile++) {
        let found = best[tile * p.rows + place];
        let other = bitcast<f32>(found.x);
        if (other < distance || (other == distance && found.y < index)) {
            distance = other;
            index = found.y;
        }
    }
    best[place] = vec2(bitcast<u32>(distance), index);
    var row = p.first_row + place;
    if (labelled) {
        row = order[row].x;
    }
    // Where no distance is a number the first row is as good as any, as on the CPU.
    out[row] = select(index, 0u, index == NONE);
}
