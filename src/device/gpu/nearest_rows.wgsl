// Nearest rows of two matrices, both ways: a workgroup of 16 × 16 compares 64 rows of x with 64 of y, and writes for each of them the nearest of the other
// 64. ‖x − y‖² = ‖x‖² + ‖y‖² − 2 x·y; ties go to the lower index. With labels the rows of either matrix come in the order of their labels, so that most
// tiles of x and y have no label in common and nothing to multiply.

struct Params {
    rows_x: u32,
    rows_y: u32,
    width: u32,
    // Rows of x in this dispatch: a multiple of 64, and how many of them.
    first_row: u32,
    slab: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
@group(0) @binding(1) var<storage, read> x: array<f32>;
@group(0) @binding(2) var<storage, read> y: array<f32>;
@group(0) @binding(3) var<storage, read> squares_x: array<f32>;
@group(0) @binding(4) var<storage, read> squares_y: array<f32>;
// With labels: index of the row and its label, in ascending order of labels and then of indices.
@group(0) @binding(5) var<storage, read> order_x: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> order_y: array<vec2<u32>>;
// Bits of the distance and index of the nearest: (1 + tiles of y, slab), of which the first row is left to the merger.
@group(0) @binding(7) var<storage, read_write> best_of_x: array<vec2<u32>>;
// (1 + tiles of x in the slab, rows_y).
@group(0) @binding(8) var<storage, read_write> best_of_y: array<vec2<u32>>;

override labelled: bool = false;

const TILE = 64u;
const SLICE = 16u;
const STRIDE = 16u;
// Label of rows that may be compared with any.
const ANY = 0xffffffffu;
const NONE = 0xffffffffu;
const FARTHEST = 3.4028234e38;

// Values of the rows at first; then distance and index of the nearest of four.
var<workgroup> slice_x: array<vec4<f32>, 256>;
var<workgroup> slice_y: array<vec4<f32>, 256>;
var<workgroup> index_x: array<vec4<u32>, 256>;
var<workgroup> index_y: array<vec4<u32>, 256>;

struct Row {
    index: u32,
    label: u32,
    // Beyond the last row.
    missing: bool,
}

struct Nearest {
    distance: f32,
    index: u32,
}

fn row_of_x(place: u32) -> Row {
    if (place >= p.rows_x) {
        return Row(NONE, 0u, true);
    }
    if (labelled) {
        return Row(order_x[place].x, order_x[place].y, false);
    }
    return Row(place, 0u, false);
}

fn row_of_y(place: u32) -> Row {
    if (place >= p.rows_y) {
        return Row(NONE, 0u, true);
    }
    if (labelled) {
        return Row(order_y[place].x, order_y[place].y, false);
    }
    return Row(place, 0u, false);
}

fn at_x(row: Row, k: u32) -> f32 {
    if (row.missing || k >= p.width) {
        return 0.0;
    }
    return x[row.index * p.width + k];
}

fn at_y(row: Row, k: u32) -> f32 {
    if (row.missing || k >= p.width) {
        return 0.0;
    }
    return y[row.index * p.width + k];
}

fn nearer(a: Nearest, b: Nearest) -> Nearest {
    if (b.distance < a.distance || (b.distance == a.distance && b.index < a.index)) {
        return b;
    }
    return a;
}

// Whether any row of a tile may be compared with any of the other. Labels ascend, and ANY is the largest.
fn share_a_label(tile_x: u32, tile_y: u32) -> bool {
    if (!labelled) {
        return true;
    }
    let least_x = order_x[tile_x].y;
    let most_x = order_x[min(tile_x + TILE, p.rows_x) - 1u].y;
    let least_y = order_y[tile_y].y;
    let most_y = order_y[min(tile_y + TILE, p.rows_y) - 1u].y;
    return most_x == ANY || most_y == ANY || (least_x <= most_y && least_y <= most_x);
}

@compute @workgroup_size(256)
fn nearest_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let tile_x = p.first_row + group.x * TILE;
    let tile_y = group.y * TILE;
    let i = lane % SLICE;
    let j = lane / SLICE;
    var sums: array<vec4<f32>, 4>;
    if (share_a_label(tile_x, tile_y)) {
        let x_0 = row_of_x(tile_x + 4u * j);
        let x_1 = row_of_x(tile_x + 4u * j + 1u);
        let x_2 = row_of_x(tile_x + 4u * j + 2u);
        let x_3 = row_of_x(tile_x + 4u * j + 3u);
        let y_0 = row_of_y(tile_y + 4u * j);
        let y_1 = row_of_y(tile_y + 4u * j + 1u);
        let y_2 = row_of_y(tile_y + 4u * j + 2u);
        let y_3 = row_of_y(tile_y + 4u * j + 3u);
        var sums_0 = vec4<f32>();
        var sums_1 = vec4<f32>();
        var sums_2 = vec4<f32>();
        var sums_3 = vec4<f32>();
        for (var first = 0u; first < p.width; first += SLICE) {
            let k = first + i;
            slice_x[i * STRIDE + j] = vec4(at_x(x_0, k), at_x(x_1, k), at_x(x_2, k), at_x(x_3, k));
            slice_y[i * STRIDE + j] = vec4(at_y(y_0, k), at_y(y_1, k), at_y(y_2, k), at_y(y_3, k));
            workgroupBarrier();
            for (var t = 0u; t < SLICE; t++) {
                let a = slice_x[t * STRIDE + j];
                let b = slice_y[t * STRIDE + i];
                sums_0 += a.x * b;
                sums_1 += a.y * b;
                sums_2 += a.z * b;
                sums_3 += a.w * b;
            }
            workgroupBarrier();
        }
        sums = array(sums_0, sums_1, sums_2, sums_3);
    }

    // Each invocation has rows 4j… of x against rows 4i… of y.
    var of_x = array(
        Nearest(FARTHEST, NONE), Nearest(FARTHEST, NONE), Nearest(FARTHEST, NONE), Nearest(FARTHEST, NONE),
    );
    var of_y = of_x;
    for (var r = 0u; r < 4u; r++) {
        let a = row_of_x(tile_x + 4u * j + r);
        for (var s = 0u; s < 4u; s++) {
            let b = row_of_y(tile_y + 4u * i + s);
            if (!a.missing && !b.missing) {
                let distance = squares_x[a.index] + squares_y[b.index] - 2.0 * sums[r][s];
                if (a.label == ANY || a.label == b.label) {
                    of_x[r] = nearer(of_x[r], Nearest(distance, b.index));
                }
                if (b.label == ANY || a.label == b.label) {
                    of_y[s] = nearer(of_y[s], Nearest(distance, a.index));
                }
            }
        }
    }
    // Four rows of x per vector, 16 candidates for each; the same for y.
    slice_x[i * STRIDE + j] = vec4(of_x[0].distance, of_x[1].distance, of_x[2].distance, of_x[3].distance);
    index_x[i * STRIDE + j] = vec4(of_x[0].index, of_x[1].index, of_x[2].index, of_x[3].index);
    slice_y[j * STRIDE + i] = vec4(of_y[0].distance, of_y[1].distance, of_y[2].distance, of_y[3].distance);
    index_y[j * STRIDE + i] = vec4(of_y[0].index, of_y[1].index, of_y[2].index, of_y[3].index);
    workgroupBarrier();
    if (lane < TILE) {
        let place = group.x * TILE + lane;
        if (place < p.slab) {
            var best = Nearest(FARTHEST, NONE);
            for (var t = 0u; t < 16u; t++) {
                let at = t * STRIDE + lane / 4u;
                best = nearer(best, Nearest(slice_x[at][lane % 4u], index_x[at][lane % 4u]));
            }
            best_of_x[(1u + group.y) * p.slab + place] = vec2(bitcast<u32>(best.distance), best.index);
        }
    } else if (lane < 2u * TILE) {
        let own = lane - TILE;
        let place = tile_y + own;
        if (place < p.rows_y) {
            var best = Nearest(FARTHEST, NONE);
            for (var t = 0u; t < 16u; t++) {
                let at = t * STRIDE + own / 4u;
                best = nearer(best, Nearest(slice_y[at][own % 4u], index_y[at][own % 4u]));
            }
            best_of_y[(1u + group.x) * p.rows_y + place] = vec2(bitcast<u32>(best.distance), best.index);
        }
    }
}
