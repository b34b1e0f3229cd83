// Masked attention, streaming: a workgroup takes 64 queries and 64 columns of the values, and goes over the keys 32 at a time. It keeps for each
// query the largest score so far and the sum of exponentials relative to it (Milakov & Gimelshein 2018, "Online normalizer calculation for softmax").

struct Params {
    queries: u32,
    keys: u32,
    // Columns of queries and keys.
    width: u32,
    parts: u32,
    // Columns of the values.
    values: u32,
    first_query: u32,
    scale: f32,
    // 1 where a key that shares no part with a query is not seen at all.
    hard: u32,
}

@group(0) @binding(0) var<uniform> p: Params;
@group(0) @binding(1) var<storage, read> query: array<f32>;
@group(0) @binding(2) var<storage, read> query_parts: array<f32>;
@group(0) @binding(3) var<storage, read> key: array<f32>;
@group(0) @binding(4) var<storage, read> key_parts: array<f32>;
@group(0) @binding(5) var<storage, read> value: array<f32>;
@group(0) @binding(6) var<storage, read_write> out: array<f32>;

const QUERIES = 64u;
const KEYS = 32u;
const SLICE = 16u;
const STRIDE = 17u;
const ROW = 33u;
// As on the CPU.
const LEAST_SHARED = 1e-6;
const LEAST_EXPONENT = -87.0;
const LOWEST = -3.4028234e38;
// Below any score: that of a key that is not seen.
const UNSEEN = -3.0e38;

// Four queries per vector; later four columns of values.
var<workgroup> left: array<vec4<f32>, 272>;
// Two keys per vector.
var<workgroup> right: array<vec2<f32>, 272>;
// Scores, then weights, of the queries (rows) for the keys at hand.
var<workgroup> weights: array<f32, 2112>;
var<workgroup> most: array<f32, QUERIES>;
var<workgroup> total: array<f32, QUERIES>;
// What earlier sums are worth beside a new largest score.
var<workgroup> fade: array<f32, QUERIES>;

fn at_query(of_parts: bool, row: u32, k: u32) -> f32 {
    if (row >= p.queries) {
        return 0.0;
    }
    if (of_parts) {
        if (k >= p.parts) {
            return 0.0;
        }
        return query_parts[row * p.parts + k];
    }
    if (k >= p.width) {
        return 0.0;
    }
    return query[row * p.width + k];
}

fn at_key(of_parts: bool, row: u32, k: u32) -> f32 {
    if (row >= p.keys) {
        return 0.0;
    }
    if (of_parts) {
        if (k >= p.parts) {
            return 0.0;
        }
        return key_parts[row * p.parts + k];
    }
    if (k >= p.width) {
        return 0.0;
    }
    return key[row * p.width + k];
}

fn at_value(row: u32, col: u32) -> f32 {
    if (row >= p.keys || col >= p.values) {
        return 0.0;
    }
    return value[row * p.values + col];
}

// Inner products of four queries with two keys: of the vectors themselves, or of their probabilities of parts.
fn products(of_parts: bool, first_query: u32, first_key: u32, lane: u32) -> array<vec2<f32>, 4> {
    let length = select(p.width, p.parts, of_parts);
    let i = lane % SLICE;
    let j = lane / SLICE;
    var sums_0 = vec2<f32>();
    var sums_1 = vec2<f32>();
    var sums_2 = vec2<f32>();
    var sums_3 = vec2<f32>();
    for (var first = 0u; first < length; first += SLICE) {
        let k = first + i;
        let row = first_query + 4u * j;
        left[i * STRIDE + j] = vec4(
            at_query(of_parts, row, k),
            at_query(of_parts, row + 1u, k),
            at_query(of_parts, row + 2u, k),
            at_query(of_parts, row + 3u, k),
        );
        let other = first_key + 2u * j;
        right[i * STRIDE + j] = vec2(at_key(of_parts, other, k), at_key(of_parts, other + 1u, k));
        workgroupBarrier();
        for (var t = 0u; t < SLICE; t++) {
            let q = left[t * STRIDE + j];
            let k = right[t * STRIDE + i];
            sums_0 += q.x * k;
            sums_1 += q.y * k;
            sums_2 += q.z * k;
            sums_3 += q.w * k;
        }
        workgroupBarrier();
    }
    return array(sums_0, sums_1, sums_2, sums_3);
}

// The score of a key that is seen only where a part is shared.
fn within(score: f32, alike: f32) -> f32 {
    if (alike > 0.0) {
        return score + log(alike);
    }
    return LOWEST;
}

fn write_scores(place: u32, product: vec2<f32>, alike: vec2<f32>) {
    if (p.hard == 1u) {
        weights[place] = within(product.x * p.scale, alike.x);
        weights[place + 1u] = within(product.y * p.scale, alike.y);
        return;
    }
    let scores = product * p.scale + log(alike + LEAST_SHARED);
    weights[place] = scores.x;
    weights[place + 1u] = scores.y;
}

fn write(row: u32, col: u32, sum: f32) {
    if (row < p.queries && col < p.values) {
        out[row * p.values + col] = sum;
    }
}

fn write_four(row: u32, col: u32, sums: vec4<f32>, all: f32) {
    // Without keys there is nothing to see.
    let scale = select(0.0, 1.0 / all, all > 0.0);
    write(row, col, sums.x * scale);
    write(row, col + 1u, sums.y * scale);
    write(row, col + 2u, sums.z * scale);
    write(row, col + 3u, sums.w * scale);
}

@compute @workgroup_size(256)
fn attend(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let first_query = p.first_query + group.x * QUERIES;
    let first_value = group.y * 64u;
    let x = lane % 16u;
    let y = lane / 16u;
    let own = 4u * y;
    if (lane < QUERIES) {
        most[lane] = LOWEST;
        total[lane] = 0.0;
    }
    var sums_0 = vec4<f32>();
    var sums_1 = vec4<f32>();
    var sums_2 = vec4<f32>();
    var sums_3 = vec4<f32>();
    for (var first_key = 0u; first_key < p.keys; first_key += KEYS) {
        let product = products(false, first_query, first_key, lane);
        let alike = products(true, first_query, first_key, lane);
        let place = own * ROW + 2u * x;
        write_scores(place, product[0], alike[0]);
        write_scores(place + ROW, product[1], alike[1]);
        write_scores(place + 2u * ROW, product[2], alike[2]);
        write_scores(place + 3u * ROW, product[3], alike[3]);
        workgroupBarrier();
        if (lane < QUERIES) {
            let row = lane * ROW;
            let here = min(KEYS, p.keys - first_key);
            let before = most[lane];
            var largest = before;
            for (var j = 0u; j < here; j++) {
                largest = max(largest, weights[row + j]);
            }
            var sum = 0.0;
            for (var j = 0u; j < KEYS; j++) {
                let seen = j < here && (p.hard == 0u || weights[row + j] > UNSEEN);
                let weight = select(0.0, exp(max(weights[row + j] - largest, LEAST_EXPONENT)), seen);
                weights[row + j] = weight;
                sum += weight;
            }
            let faded = exp(max(before - largest, LEAST_EXPONENT));
            most[lane] = largest;
            total[lane] = total[lane] * faded + sum;
            fade[lane] = faded;
        }
        workgroupBarrier();
        sums_0 *= fade[own];
        sums_1 *= fade[own + 1u];
        sums_2 *= fade[own + 2u];
        sums_3 *= fade[own + 3u];
        for (var slice = 0u; slice < KEYS; slice += SLICE) {
            let row = first_key + slice + y;
            let col = first_value + 4u * x;
            left[y * STRIDE + x] =
                vec4(at_value(row, col), at_value(row, col + 1u), at_value(row, col + 2u), at_value(row, col + 3u));
            workgroupBarrier();
            for (var t = 0u; t < SLICE; t++) {
                let seen = left[t * STRIDE + x];
                let place = own * ROW + slice + t;
                sums_0 += weights[place] * seen;
                sums_1 += weights[place + ROW] * seen;
                sums_2 += weights[place + 2u * ROW] * seen;
                sums_3 += weights[place + 3u * ROW] * seen;
            }
            workgroupBarrier();
        }
    }
    workgroupBarrier();
    let row = first_query + own;
    let col = first_value + 4u * x;
    write_four(row, col, sums_0, total[own]);
    write_four(row + 1u, col, sums_1, total[own + 1u]);
    write_four(row + 2u, col, sums_2, total[own + 2u]);
    write_four(row + 3u, col, sums_3, total[own + 3u]);
}
