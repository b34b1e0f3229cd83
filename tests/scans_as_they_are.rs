//! Scans as people have them: chunks whose borders were rounded apart, clothes over skin, spikes, rows that are no numbers, uneven clouds, floors, boxes and other people.
#![cfg(not(target_arch = "wasm32"))]

use std::path::PathBuf;
use std::sync::LazyLock;

use geose_fmap::operators::LaplacianKind;
use geose_fmap::pipeline::{ShapeKind, prepare};
use geose_fmap::{Error, Match, MatchOptions, Matcher, PrepareOptions, PreparedShape, Progress, Shape, UNMATCHED};

static MATCHER: LazyLock<Matcher> = LazyLock::new(Matcher::new);
/// Both are the same woman, vertex by vertex.
static STANDING: LazyLock<Scan> = LazyLock::new(|| Scan::sample("woman-standing.ply"));
static STRIDING: LazyLock<Shape> = LazyLock::new(|| Scan::sample("woman-striding.ply").shape());
static TARGET: LazyLock<PreparedShape> =
    LazyLock::new(|| MATCHER.prepare(STRIDING.clone(), &PrepareOptions::default()).expect("prepared"));

/// Points and faces, and for each point the vertex of the sample it is.
#[derive(Clone)]
struct Scan {
    points: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    vertex: Vec<Option<u32>>,
}

impl Scan {
    fn sample(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("www/public/samples").join(name);
        let shape = geose_fmap::read(&std::fs::read(path).expect("a sample"), Some(name), None).expect("read");
        let vertex = (0..shape.points().len() as u32).map(Some).collect();
        Self { points: shape.points().to_vec(), faces: shape.faces().to_vec(), vertex }
    }

    fn shape(&self) -> Shape {
        Shape::new(self.points.clone(), self.faces.clone(), None).expect("a shape")
    }

    fn cloud(mut self) -> Self {
        self.faces.clear();
        self
    }

    /// With something that is not the body.
    fn and(mut self, (points, faces): (Vec<[f64; 3]>, Vec<[u32; 3]>)) -> Self {
        let first = self.points.len() as u32;
        self.vertex.extend(points.iter().map(|_| None));
        self.points.extend(points);
        self.faces.extend(faces.iter().map(|face| face.map(|i| i + first)));
        self
    }

    /// Cut into chunks by `chunk` of a face's middle; every chunk has points of its own, changed by `rounded`.
    fn in_chunks(&self, mut chunk: impl FnMut([f64; 3]) -> u32, rounded: impl Fn(u32, [f64; 3]) -> [f64; 3]) -> Self {
        let mut cut = Self { points: Vec::new(), faces: Vec::new(), vertex: Vec::new() };
        let mut known = std::collections::BTreeMap::new();
        for face in &self.faces {
            let middle = std::array::from_fn(|c| face.iter().map(|&i| self.points[i as usize][c]).sum::<f64>() / 3.0);
            let number = chunk(middle);
            cut.faces.push(face.map(|i| {
                *known.entry((number, i)).or_insert_with(|| {
                    cut.points.push(rounded(number, self.points[i as usize]));
                    cut.vertex.push(Some(i));
                    cut.points.len() as u32 - 1
                })
            }));
        }
        cut
    }
}

fn prepared(scan: &Scan) -> PreparedShape {
    MATCHER.prepare(scan.shape(), &PrepareOptions::default()).expect("prepared")
}

fn said(shape: &PreparedShape, code: &str) -> bool {
    shape.repairs.iter().any(|repair| repair.code == code)
}

/// Mean distance in centimetres from where points of the body go to where they belong, the share that goes nowhere, and mean confidence.
fn error(scan: &Scan, found: &Match) -> (f64, f64, f64) {
    let (mut sum, mut count, mut lost) = (0.0, 0, 0);
    for (i, vertex) in scan.vertex.iter().enumerate() {
        let Some(vertex) = vertex else { continue };
        match found.a_to_b.target[i] {
            UNMATCHED => lost += 1,
            target => {
                let [p, q] = [target, *vertex].map(|j| STRIDING.points()[j as usize]);
                sum += 100.0 * (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt();
                count += 1;
            }
        }
    }
    let confidence = found.a_to_b.confidence.iter().map(|&c| f64::from(c)).sum::<f64>() / scan.points.len() as f64;
    (sum / f64::from(count), f64::from(lost) / f64::from(count + lost), confidence)
}

fn matched(scan: &Scan) -> (PreparedShape, (f64, f64, f64)) {
    let shape = prepared(scan);
    let found = MATCHER.match_shapes(&shape, &TARGET, &MatchOptions::default()).expect("matched");
    let error = error(scan, &found);
    println!("{error:?} {:?}", shape.repairs.iter().map(|repair| &*repair.code).collect::<Vec<_>>());
    (shape, error)
}

/// A flat grid, `step` apart.
fn plate(corner: [f64; 3], sides: [[f64; 3]; 2], step: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let count = sides.map(|side| (side.iter().map(|x| x * x).sum::<f64>().sqrt() / step).round() as u32);
    let (across, along) = (count[0], count[1]);
    let place = |i: u32, j: u32| {
        std::array::from_fn(|c| {
            corner[c] + sides[0][c] * f64::from(i) / f64::from(across) + sides[1][c] * f64::from(j) / f64::from(along)
        })
    };
    let points = (0..=across).flat_map(|i| (0..=along).map(move |j| place(i, j))).collect();
    let at = |i: u32, j: u32| i * (along + 1) + j;
    let squares = (0..across).flat_map(|i| (0..along).map(move |j| (i, j)));
    let faces = squares
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]);
    (points, faces.collect())
}

/// Noise between −1 and 1 that only depends on what is given.
fn noise(seed: u64) -> f64 {
    let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    2.0 * ((x ^ (x >> 29)) >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
}

#[test]
fn chunks_whose_borders_were_rounded_apart_are_one_surface() {
    let chunk = |[x, y, _]: [f64; 3]| (y / 0.3) as u32 * 2 + u32::from(x > 0.0);
    let apart = |by: f64| {
        move |chunk: u32, p: [f64; 3]| {
            std::array::from_fn(|c| p[c] + by * noise(u64::from(chunk) * 8 + c as u64 + p[c].to_bits()))
        }
    };
    let step = 2.0 / f64::from(1 << 14);
    let quantised = |chunk: u32, p: [f64; 3]| {
        p.map(|x| ((x + 1e-3 * f64::from(chunk)) / step).round() * step - 1e-3 * f64::from(chunk))
    };
    for (name, scan) in [
        ("1e-7", STANDING.in_chunks(chunk, apart(1e-7))),
        ("1e-5", STANDING.in_chunks(chunk, apart(1e-5))),
        ("14 bits", STANDING.in_chunks(chunk, quantised)),
    ] {
        let (shape, (error, lost, _)) = matched(&scan);
        assert!(said(&shape, "seams-joined") && shape.info.pieces == 1, "{name}");
        assert!(error <= 0.5 && lost == 0.0, "{name}: {error} cm");
    }
}

#[test]
fn loose_triangles_whose_corners_were_rounded_apart_are_one_surface() {
    let mut face = 0;
    let soup = STANDING.in_chunks(
        |_| {
            face += 1;
            face
        },
        |face, p| std::array::from_fn(|c| p[c] + 1e-7 * noise(u64::from(face) * 8 + c as u64 + p[c].to_bits())),
    );
    let (_, (error, lost, _)) = matched(&soup);
    assert!(error <= 0.5 && lost == 0.0, "{error} cm");
}

#[test]
fn a_body_in_shells_is_one_body() {
    // Head, arms, legs and trunk are shells of their own that overlap by the triangles at the cuts; trunk and legs a centimetre outside.
    let shell = |[x, y, _]: [f64; 3]| {
        if y > 1.38 {
            0
        } else if x.abs() > 0.2 {
            1 + u32::from(x > 0.0)
        } else if y > 0.75 {
            3
        } else {
            4 + u32::from(x > 0.0)
        }
    };
    let axis = |shell: u32| match shell {
        0 | 3 => [0.0, 0.0],
        4 => [-0.1, 0.0],
        _ => [0.1, 0.0],
    };
    let out = |shell: u32, p: [f64; 3]| {
        if ![3, 4, 5].contains(&shell) {
            return p;
        }
        let [dx, dz] = [p[0] - axis(shell)[0], p[2] - axis(shell)[1]];
        let length = dx.hypot(dz).max(1e-6);
        [p[0] + 0.01 * dx / length, p[1], p[2] + 0.01 * dz / length]
    };
    let avatar = STANDING.in_chunks(shell, out);
    let (shape, (error, lost, _)) = matched(&avatar);
    assert!(said(&shape, "shells-joined"));
    assert_eq!((shape.info.kind, shape.info.pieces), (ShapeKind::Cloud, 1));
    assert!(error <= 4.0 && lost == 0.0, "{error} cm");
    // What is between uploaded points is stored with them.
    let again = PreparedShape::from_bytes(&shape.to_bytes().expect("bytes")).expect("stored");
    assert_eq!(again.resampled, shape.resampled);
    let onto = |shape: &PreparedShape| MATCHER.match_shapes(&TARGET, shape, &MatchOptions::default()).expect("matched");
    let (now, then) = (onto(&shape), onto(&again));
    assert_eq!(now.a_to_b, then.a_to_b);
    assert!(now.a_to_b.target.iter().all(|&j| (j as usize) < avatar.points.len()), "targets are uploaded points");
}

#[test]
fn a_skirt_with_a_lining_goes_with_the_body_below_it() {
    let waist = 1.0;
    let around = STANDING.points.iter().filter(|p| (p[1] - waist).abs() < 0.02 && p[0].abs() < 0.22);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in around {
        for (side, c) in [0, 2].into_iter().enumerate() {
            (low[side], high[side]) = (low[side].min(p[c]), high[side].max(p[c]));
        }
    }
    let middle = [0, 1].map(|side| 0.5 * (low[side] + high[side]));
    let reach = [0, 1].map(|side| 0.5 * (high[side] - low[side]));
    // From the waist, where it lies on the skin, to the shanks, where it is wide.
    let skirt = |inside: f64| {
        let (points, faces) = plate([0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0.02);
        let onto = |[turn, down, _]: [f64; 3]| {
            let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
            let wide = [0, 1].map(|side| reach[side] + 0.01 + down * (0.33 - reach[side]) - inside);
            [middle[0] + wide[0] * cos, waist - 0.6 * down, middle[1] + wide[1] * sin]
        };
        (points.into_iter().map(onto).collect(), faces)
    };
    let dressed = STANDING.clone().and(skirt(0.0)).and(skirt(0.006));
    let (shape, (error, lost, confidence)) = matched(&dressed);
    assert!(said(&shape, "garment-set-aside"));
    // What is left is a mesh.
    assert_eq!(shape.info.laplacian, LaplacianKind::Cotangent);
    assert!(error <= 0.5 && lost == 0.0 && confidence > 0.8, "{error} cm, {lost}, {confidence}");
    // The skirt has partners, too.
    assert_eq!(shape.support.unmatched, None);
}

#[test]
fn spikes_to_the_origin_are_cut() {
    let mut scan = STANDING.clone();
    scan.points.iter_mut().for_each(|p| p[2] += 2.2);
    let origin = scan.points.len() as u32;
    scan = scan.and((vec![[0.0; 3]], Vec::new()));
    for (number, face) in scan.faces.iter_mut().enumerate().filter(|(number, _)| number % 40 == 0) {
        face[number % 3] = origin;
    }
    let (shape, (error, lost, _)) = matched(&scan);
    assert!(said(&shape, "spikes-cut"));
    assert!(error <= 0.5 && lost == 0.0, "{error} cm");
}

#[test]
fn points_that_are_no_numbers_are_matched_with_nothing_and_keep_their_numbers() {
    let mut scan = STANDING.clone().cloud();
    for i in (0..scan.points.len()).filter(|i| i % 3 == 0) {
        scan.points[i] = [f64::NAN; 3];
        scan.vertex[i] = None;
    }
    let shape = prepared(&scan);
    assert!(said(&shape, "points-without-place"));
    let found = MATCHER.match_shapes(&shape, &TARGET, &MatchOptions::default()).expect("matched");
    for (i, &target) in found.a_to_b.target.iter().enumerate() {
        assert_eq!(target == UNMATCHED, i % 3 == 0, "{i}");
    }
    assert!(found.b_to_a.target.iter().all(|i| i % 3 != 0), "nothing goes to them");
    let (error, ..) = error(&scan, &found);
    assert!(error <= 3.0, "{error} cm");
    let again = PreparedShape::from_bytes(&shape.to_bytes().expect("bytes")).expect("stored");
    assert_eq!(again.shape.placeless(), shape.shape.placeless());
    assert_eq!(MATCHER.match_shapes(&again, &TARGET, &MatchOptions::default()).expect("matched").a_to_b, found.a_to_b);
}

#[test]
fn a_trunk_that_is_sampled_thinly_belongs_to_the_body() {
    let mut scan = STANDING.clone().cloud();
    let trunk = |p: &[f64; 3]| p[0].abs() < 0.2 && (0.75..1.35).contains(&p[1]);
    let kept: Vec<usize> = (0..scan.points.len()).filter(|&i| !trunk(&scan.points[i]) || i % 8 == 0).collect();
    scan.points = kept.iter().map(|&i| scan.points[i]).collect();
    scan.vertex = kept.iter().map(|&i| scan.vertex[i]).collect();
    let (shape, (error, lost, _)) = matched(&scan);
    assert!(error <= 3.0 && lost == 0.0, "{error} cm, {lost}");
    assert!(said(&shape, "thinly-sampled") && shape.info.reliability < 1.0, "{}", shape.info.reliability);
}

#[test]
fn legs_that_are_sampled_much_more_thinly_are_no_strays() {
    // Less than one point in a hundred is on a leg.
    let mut scan = STANDING.clone().cloud();
    let legs = |p: &[f64; 3]| p[1] < 0.85 && p[0].abs() < 0.35;
    let fine = Scan::sample("woman-standing.ply");
    for face in &fine.faces {
        let corners = face.map(|i| fine.points[i as usize]);
        for (a, b) in [(0, 1), (1, 2), (2, 0), (0, 2)] {
            let point =
                std::array::from_fn(|c| 0.6 * corners[a][c] + 0.3 * corners[b][c] + 0.1 * corners[3 - a - b][c]);
            scan.points.push(point);
            scan.vertex.push(None);
        }
    }
    let mut thin = 0;
    let kept: Vec<usize> = (0..scan.points.len())
        .filter(|&i| {
            thin += usize::from(legs(&scan.points[i]) && scan.vertex[i].is_some());
            !legs(&scan.points[i]) || scan.vertex[i].is_some() && thin % 6 == 0
        })
        .collect();
    scan.points = kept.iter().map(|&i| scan.points[i]).collect();
    scan.vertex = kept.iter().map(|&i| scan.vertex[i]).collect();
    let on_legs = scan.points.iter().filter(|p| legs(p)).count();
    assert!(on_legs * 50 < scan.points.len(), "{on_legs} of {}", scan.points.len());
    let (shape, (error, lost, _)) = matched(&scan);
    assert!(said(&shape, "thin-parts-kept"));
    assert!(error <= 3.0 && lost < 0.01, "{error} cm, {lost}");
}

#[test]
fn points_in_the_air_around_a_body_are_set_aside() {
    let body = STANDING.clone().cloud();
    let air = (0..250).map(|i| {
        let [x, y, z] = [0, 1, 2].map(|c| 0.5 * noise(3 * i + c + 99) + 0.5);
        [1.6 * x - 0.8, 1.7 * y, 0.5 * z - 0.25]
    });
    let count = body.points.len();
    let (shape, (error, lost, _)) = matched(&body.and((air.collect(), Vec::new())));
    let set_aside = shape.support.unmatched.as_deref().unwrap_or_default();
    let in_air = set_aside.iter().filter(|&&i| i as usize >= count).count();
    assert!(in_air > 150, "{in_air} of 250");
    assert!(error <= 2.0 && lost < 0.01, "{error} cm, {lost}");
}

#[test]
fn a_gap_in_a_leg_makes_no_other_thing_of_the_foot() {
    let mut scan = STANDING.clone().cloud();
    let gap = |p: &[f64; 3]| p[0] > 0.0 && (0.4..0.6).contains(&p[1]);
    let kept: Vec<usize> = (0..scan.points.len()).filter(|&i| !gap(&scan.points[i])).collect();
    scan.points = kept.iter().map(|&i| scan.points[i]).collect();
    scan.vertex = kept.iter().map(|&i| scan.vertex[i]).collect();
    let (shape, (error, lost, _)) = matched(&scan);
    assert!(!said(&shape, "others-set-aside"));
    assert!(error <= 3.5 && lost == 0.0, "{error} cm, {lost}");
}

#[test]
fn floors_are_found_when_they_are_noisy_and_when_a_point_lies_kilometres_away() {
    let floor = |side: f64, sigma: f64| {
        let (mut points, faces) = plate([-0.5 * side, 0.0, -0.5 * side], [[side, 0.0, 0.0], [0.0, 0.0, side]], 0.02);
        for (i, p) in points.iter_mut().enumerate() {
            // Nearly normal, like a camera's.
            p[1] += sigma * (0..3).map(|k| noise(9 * i as u64 + k)).sum::<f64>();
        }
        (points, faces)
    };
    for (side, sigma) in [(0.7, 0.005), (2.0, 0.01)] {
        let (shape, (error, lost, _)) = matched(&STANDING.clone().and(floor(side, sigma)).cloud());
        assert!(said(&shape, "floor-set-aside"), "{side} m, {sigma} m");
        assert!(error <= 3.0 && lost < 0.02, "{side} m, {sigma} m: {error} cm, {lost}");
    }
    let far = STANDING.clone().and(floor(2.0, 0.0)).and((vec![[5000.0, 0.0, 0.0]], Vec::new()));
    let (shape, (error, lost, _)) = matched(&far.cloud());
    assert!(said(&shape, "floor-set-aside"));
    assert!(error <= 3.0 && lost < 0.02, "{error} cm, {lost}");
}

#[test]
fn what_a_hand_holds_is_no_part_of_the_body() {
    // A ball of 32 centimetres before a hand, a mesh of its own as it would be in a modeller's file.
    let hand = STANDING.points.iter().fold([0.0_f64; 3], |most, p| if p[0] > most[0] { *p } else { most });
    let (grid, faces) = plate([0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0.05);
    let onto = |[turn, down, _]: [f64; 3]| {
        let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
        let (round, height) = (std::f64::consts::PI * down).sin_cos();
        [hand[0] + 0.16 * round * cos, hand[1] + 0.16 * height, hand[2] + 0.17 + 0.16 * round * sin]
    };
    let ball = (grid.into_iter().map(onto).collect(), faces);
    let (shape, (error, lost, confidence)) = matched(&STANDING.clone().and(ball));
    assert!(said(&shape, "piece-set-aside"));
    assert!(error <= 0.5 && lost == 0.0 && confidence > 0.8, "{error} cm, {lost}, {confidence}");
    // Its far side is nobody's.
    assert!(shape.support.unmatched.is_some_and(|points| points.len() > 50));
}

#[test]
fn what_no_network_knows_stands_on_a_floor_all_the_same_and_has_sides_of_its_own() {
    let pear = (0..3000).map(|i| {
        let (z, turn) = (1.0 - f64::from(2 * i + 1) / 3000.0, f64::from(i) * 2.399963);
        let r = (1.0 - z * z).sqrt() * (0.5 - 0.2 * z);
        [r * turn.cos(), 0.7 * (1.0 + z), r * turn.sin()]
    });
    let vertex = vec![None; 3000];
    let pear = Scan { points: pear.collect(), faces: Vec::new(), vertex };
    let (floor, _) = plate([-1.0, 0.0, -1.0], [[2.0, 0.0, 0.0], [0.0, 0.0, 2.0]], 0.04);
    let (first, floor) = (pear.points.len() as u32, (floor, Vec::new()));
    let shape = prepared(&pear.clone().and(floor));
    assert!(said(&shape, "floor-set-aside"));
    let unmatched = shape.support.unmatched.as_deref().expect("the floor");
    // What of the pear lies in the plane cannot be told from it.
    let of_floor = |i: u32| i >= first || pear.points[i as usize][1] < 0.03;
    assert!(unmatched.len() > 2400 && unmatched.iter().all(|&i| of_floor(i)), "{}", unmatched.len());
    // The flat side of a half is its own.
    let mut half = pear;
    half.points.iter_mut().for_each(|p| p[2] = p[2].max(-0.05));
    assert!(!said(&prepared(&half), "floor-set-aside"));
}

#[test]
fn a_scan_of_two_things_is_stopped_wherever_one_likes() {
    let beside: Vec<[f64; 3]> = STANDING.points.iter().map(|p| [0.75 * p[0] + 1.0, 0.75 * p[1], 0.75 * p[2]]).collect();
    let scan = STANDING.clone().and((beside, STANDING.faces.clone())).cloud();
    let heard = std::cell::RefCell::new(Vec::new());
    let mut listening = Progress::new(|stage, share| {
        heard.borrow_mut().push((stage, share));
        true
    });
    prepare(scan.shape(), None, &PrepareOptions::default(), &mut listening).expect("prepared");
    drop(listening);
    let heard = heard.into_inner();
    let back = heard.windows(2).find(|pair| pair[0].0 == pair[1].0 && pair[0].1 > pair[1].1);
    assert!(back.is_none(), "progress goes back: {back:?}");
    let calls = heard.len();
    // The last calls are those of the views of the scan without one of its things.
    for stop in (1..calls).step_by((calls / 12).max(1)) {
        let mut left = stop;
        let mut stopping = Progress::new(|_, _| {
            left -= 1;
            left > 0
        });
        let stopped = prepare(scan.shape(), None, &PrepareOptions::default(), &mut stopping);
        assert!(matches!(stopped, Err(Error::Cancelled(_))), "after {stop} calls");
    }
}

#[test]
fn coordinates_in_coarse_steps_are_said_and_trusted_less() {
    let mut scan = STANDING.clone().cloud();
    scan.points.iter_mut().flatten().for_each(|x| *x = f64::from((*x + 4e5) as f32));
    let (shape, (_, _, confidence)) = matched(&scan);
    assert!(said(&shape, "coarse-numbers") && shape.info.reliability < 0.5);
    assert!(confidence < 0.6, "{confidence}");
    assert!(!said(&TARGET, "coarse-numbers") && TARGET.info.reliability == 1.0);
}

#[test]
fn floors_boxes_and_other_people_are_set_aside() {
    let (x, z) = (0.0, 0.05);
    let floor =
        |side: f64, step: f64| plate([x - side / 2.0, 0.0, z - side / 2.0], [[side, 0.0, 0.0], [0.0, 0.0, side]], step);
    let behind = STANDING.points.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min);
    let cube = || {
        let corner = [-0.2, 0.0, behind - 0.42];
        let edges = [[0.4, 0.0, 0.0], [0.0, 0.45, 0.0], [0.0, 0.0, 0.4]];
        let side = |at: usize, far: bool| {
            let from = std::array::from_fn(|c| corner[c] + if far { edges[at][c] } else { 0.0 });
            plate(from, [edges[(at + 1) % 3], edges[(at + 2) % 3]], 0.02)
        };
        (0..6).map(|s| side(s / 2, s % 2 == 1)).fold((Vec::new(), Vec::new()), |(mut points, mut faces), (p, f)| {
            let first = points.len() as u32;
            points.extend(p);
            faces.extend(f.iter().map(|face: &[u32; 3]| face.map(|i| i + first)));
            (points, faces)
        })
    };
    let other = Scan::sample("man-standing.ply");
    let beside: Vec<[f64; 3]> = other.points.iter().map(|p| [0.75 * p[0] + 1.0, 0.75 * p[1], 0.75 * p[2]]).collect();
    let things = [
        ("a plate", floor(0.7, 0.02), "floor-set-aside"),
        ("a floor", floor(2.0, 0.02), "floor-set-aside"),
        ("a wall", plate([-0.75, 0.0, behind - 0.05], [[1.5, 0.0, 0.0], [0.0, 2.0, 0.0]], 0.02), "floor-set-aside"),
        ("a box", cube(), "furniture-set-aside"),
        ("another person", (beside, other.faces.clone()), "others-set-aside"),
    ];
    for as_cloud in [false, true] {
        let form = |scan: Scan| if as_cloud { scan.cloud() } else { scan };
        let alone = form(STANDING.clone());
        let (shape, (usual, ..)) = matched(&alone);
        assert!(shape.repairs.iter().all(|repair| !repair.code.ends_with("set-aside")), "nothing beside the body");
        for (name, thing, code) in &things {
            let scan = form(STANDING.clone().and(thing.clone()));
            let (shape, (error, lost, _)) = matched(&scan);
            assert!(said(&shape, code), "{name}, cloud {as_cloud}");
            assert!(
                error <= 1.5 * usual.max(0.3) && lost < 0.005,
                "{name}, cloud {as_cloud}: {error} cm, {usual} alone, {lost}"
            );
            if *name == "a floor" {
                let aside = shape.repairs.iter().find(|repair| repair.code == *code).map_or(0, |repair| repair.count);
                let low = STANDING.points.iter().filter(|point| point[1] < 0.01).count();
                assert!(aside <= thing.0.len() + low, "{aside} points go, {low} of the body lie on the floor");
            }
        }
    }
    // Who wants all of it gets all of it.
    let whole = PrepareOptions { whole_scan: true, ..PrepareOptions::default() };
    let kept = MATCHER.prepare(STANDING.clone().and(floor(0.7, 0.02)).shape(), &whole).expect("prepared");
    assert!(!said(&kept, "floor-set-aside"));
}
