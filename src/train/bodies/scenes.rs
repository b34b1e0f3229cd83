//! Scenes beside the same bodies alone, in the layout that `evaluate` reads.

use std::path::Path;

use super::BodyModel;
use super::layout::Layout;
use super::parts::PARTS;
use super::samples::SampleError;
use super::scene::{CODES, POINTS};
use super::write::write_ply;

/// Names of the shapes of one scene.
#[derive(Clone, Debug, PartialEq)]
struct Names {
    mesh: Option<String>,
    cloud: Option<String>,
    clean: String,
}

/// Writes `count` scenes, one kind after another, each with another body, and returns the names of the shapes.
pub fn write_scenes(model: &BodyModel, out: &Path, count: usize, seed: u64) -> Result<Vec<String>, SampleError> {
    let layout = Layout::new(out, &["ply"])?;
    let template = model.template(POINTS)?;
    let mut all = Vec::new();
    for i in 0..count {
        let code = CODES[i % CODES.len()];
        let scene = model.scene(&template, code, seed + i as u64)?;
        let name = |form: &str| format!("{:06}-{code}-{form}", seed + i as u64);
        let names = Names {
            mesh: scene.mesh.is_some().then(|| name("mesh")),
            cloud: scene.cloud.is_some().then(|| name("cloud")),
            clean: name("clean"),
        };
        let shapes = [(&names.mesh, &scene.mesh), (&names.cloud, &scene.cloud)];
        for (name, shape) in shapes.into_iter().filter_map(|(name, shape)| Some((name.as_ref()?, shape.as_ref()?))) {
            layout.shape(name, shape, model, &template)?;
        }
        layout.shape(&names.clean, &scene.clean, model, &template)?;
        if let (Some((rows, row_of)), Some(cloud)) = (&scene.rows, &names.cloud) {
            let mut ply = Vec::new();
            write_ply(&mut ply, rows, &[], None, &[]).expect("writing to memory does not fail");
            layout.save(&format!("ply/{cloud}.ply"), ply)?;
            layout.lines(&format!("ply/{cloud}.rows.txt"), row_of)?;
        }
        all.push(names);
    }
    let pairs = |of: &dyn Fn(&Names) -> Vec<String>| pairs(&all, of);
    layout.lines("pairs.txt", &pairs(&|n| [&n.mesh, &n.cloud].into_iter().flatten().cloned().collect()))?;
    layout.lines("pairs-mesh.txt", &pairs(&|n| n.mesh.iter().cloned().collect()))?;
    layout.lines("pairs-cloud.txt", &pairs(&|n| n.cloud.iter().cloned().collect()))?;
    let parts: Vec<String> = PARTS.iter().map(|p| p.replace(' ', "_")).chain(["thing".to_owned()]).collect();
    layout.save("labels.json", format!("{}\n", serde_json::json!(parts)).into_bytes())?;
    layout.lines("NOTE.txt", &[note(count, seed)])?;
    Ok(all.into_iter().flat_map(|n| n.mesh.into_iter().chain(n.cloud).chain([n.clean])).collect())
}

/// What `of` names of each scene to the next body alone, followed by the body alone to the same.
fn pairs(all: &[Names], of: &dyn Fn(&Names) -> Vec<String>) -> Vec<String> {
    let mut pairs = Vec::new();
    for (i, names) in all.iter().enumerate().filter(|_| all.len() > 1) {
        let target = &all[(i + 1) % all.len()].clean;
        let mut scenes = of(names);
        if !scenes.is_empty() {
            scenes.push(names.clean.clone());
        }
        pairs.extend(scenes.iter().map(|scene| format!("{scene} {target}")));
    }
    pairs
}

fn note(count: usize, seed: u64) -> String {
    format!(
        "{count} scenes of this project's generator, seeds from {seed}: a body with what scans have besides it, or sampled as scans are, as SEED-KIND-mesh \
         and SEED-KIND-cloud, and the body alone, SEED-KIND-clean. Points of the things have the label “thing” and no truth; a line is 0 where the body \
         was not seen. pairs-mesh.txt is for --mode mesh, pairs-cloud.txt for --mode cloud, pairs.txt is both. ply/ has clouds with rows that are no \
         numbers; .rows.txt is the row (0-based) of each point of the shape of that name. Metres, y up, but depth scans have their first camera at the \
         origin. Kinds: {}. CC0.",
        CODES.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_and_its_body_go_to_the_same_other_body() {
        let names = |i: usize| Names {
            mesh: (i != 1).then(|| format!("{i}-mesh")),
            cloud: (i != 0).then(|| format!("{i}-cloud")),
            clean: format!("{i}-clean"),
        };
        let all = [names(0), names(1), names(2)];
        let meshes = pairs(&all, &|n| n.mesh.iter().cloned().collect());
        assert_eq!(meshes, ["0-mesh 1-clean", "0-clean 1-clean", "2-mesh 0-clean", "2-clean 0-clean"]);
    }
}
