//! From a scan to what can be matched.

use super::body::{Scan, body_of};
use super::contact::edges_between_limbs;
use super::embedding::ask;
use super::geometry::Geometry;
use super::scan::{NOT_PROVED, not_proved};
use super::{Error, PrepareOptions, PreparedShape, ShapeKind};
use crate::device::Device;
use crate::network::{Model, PointEmbedding};
use crate::operators::EdgeFilter;
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::{Repair, Shape, counted};
use crate::vector::longest_side;

/// Scan → graph → Laplacian → spectrum → features and parts, on the CPU with the weights that ship; on a cloud on which limbs touch from the graph on once more,
/// limbs told apart by those parts.
pub fn prepare(
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    progress: &mut Progress,
) -> Result<PreparedShape, Error> {
    // Nothing on the CPU ever waits.
    pollster::block_on(prepare_with(Model::embedded(), shape, name, options, progress))
}

/// [`prepare`] with other weights, or on another device.
pub async fn prepare_with<D: Device>(
    model: &Model<D>,
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    progress: &mut Progress<'_>,
) -> Result<PreparedShape, Error> {
    let wanted = model.weights().map(|weights| weights.config.eigenpairs).max().unwrap_or(0);
    let scan = Scan { shape, name, options, wanted };
    let (mut prepared, carriers, laplacian) = body_of(model, scan, progress).await?;
    if prepared.basis.k() < wanted {
        let found = prepared.basis.k();
        let message = format!(
            "the scan has {found} eigenpairs and the network looks at {wanted}: it sees less of it than it should"
        );
        prepared.repairs.push(Repair::noted("few-eigenpairs", found, message));
    }
    // Kept through the network only where it may be needed again.
    let by_default = prepared.info.kind == ShapeKind::Cloud && options.laplacian.is_none();
    let laplacian = by_default.then_some(laplacian);
    let home = prepared.embeddings.first().cloned();
    let in_contact =
        laplacian.zip(home).and_then(|(laplacian, home)| Some((edges_between_limbs(&laplacian, &home)?, home)));
    if let Some((edges, PointEmbedding { category, parts, .. })) = in_contact {
        // A Laplacian and a spectrum again, but a listener is not told of a stage twice.
        let mut within = Progress::new(|_, _| progress.at(Stage::Features, 0.5).is_ok());
        let (kind, sampled) = (prepared.info.laplacian, (&prepared.support, &prepared.coarse[..]));
        let meet = |i: u32, j: u32| f64::from(category.meeting(parts.row(i as usize), parts.row(j as usize)));
        let apart =
            Geometry::of(&carriers, kind, Some(&meet), sampled, [options.eigenpairs, prepared.basis.k()], &mut within);
        drop(within);
        match apart {
            Ok(apart) => {
                let message = format!(
                    "{} of neighbours join parts of the body that do not meet, as where limbs touch: they were told apart",
                    counted(edges, "pair", "pairs")
                );
                prepared.repairs.retain(|repair| repair.code != NOT_PROVED);
                prepared.repairs.push(Repair::noted("limbs-told-apart", edges, message));
                prepared.repairs.extend(not_proved(&apart.report, &apart.basis));
                prepared.info.residual = apart.report.residual;
                (prepared.basis, prepared.features, prepared.surface) = (apart.basis, apart.features, apart.surface);
                let filter = options.part_aware_gradients.then_some(&meet as EdgeFilter);
                ask(model, &mut prepared, &carriers, filter, options.share, 0.8..0.9, progress).await?;
            }
            Err(Error::Cancelled(_)) => return Err(Cancelled { stage: Stage::Features }.into()),
            // The basis that knows no parts is there and good.
            Err(_) => {}
        }
    }
    let extent = prepared.embeddings.first().and_then(|home| home.category.extent);
    prepared.info.unit = extent.and_then(|extent| unit(&prepared.points_of_rows(), extent));
    progress.at(Stage::Features, 1.0)?;
    if prepared.basis.k() > prepared.info.eigenpairs {
        prepared.basis = prepared.basis.truncated(prepared.info.eigenpairs);
    }
    prepared.info.seconds = progress.take_seconds();
    Ok(prepared)
}

/// The unit in which the longest side of the scan's box is that of a body of the category, `shortest` to `longest` metres.
fn unit(points: &[[f64; 3]], [shortest, longest]: [f64; 2]) -> Option<String> {
    let side = longest_side(points.iter().copied());
    [("m", 1.0), ("cm", 100.0), ("mm", 1000.0)]
        .into_iter()
        .find(|(_, per_metre)| (shortest..longest).contains(&(side / per_metre)))
        .map(|(name, _)| name.to_owned())
}
