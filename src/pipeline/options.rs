//! What a user may ask for, with defaults.

use std::fmt::Display;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::network::WeightsId;
use crate::operators::LaplacianKind;
use crate::progress::Listener;
use crate::registration::Refinement;
use crate::shape::Axis;

/// Options of [`Matcher::prepare`](crate::Matcher::prepare).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
pub struct PrepareOptions {
    /// Points that take part, 50 to 2 million; up to 1.5 times as many stay whole. Basis and network see all of them; a match compares every point of one shape with
    /// every point of the other, and so at most 7500 of each, evenly chosen, and lifts the rest.
    pub points: usize,
    /// Whether faces count, or the scan is taken as a cloud.
    pub faces: FaceUse,
    /// Which Laplacian; by default cotangents on meshes and on clouds the geodesic one, in which body parts that the network tells apart hold limbs in contact
    /// apart (the repair `limbs-told-apart` says where). One that is asked for by name knows nothing of parts.
    pub laplacian: Option<LaplacianKind>,
    /// Eigenpairs k of the basis, 10 to 1000 (paper: 120). The network has as many as it was trained with besides; the repair `few-eigenpairs` says where a shape
    /// cannot have them.
    pub eigenpairs: usize,
    /// The axis that points up, where it is known; only shown so far, since matching does not depend on it.
    pub up: Option<Axis>,
    /// Whether all of the scan is the body. Else floors, furniture, other bodies, loose pieces and garments are set aside where the network is more certain of what is left; the repairs say so.
    pub whole_scan: bool,
    /// How much of a body's surface the scan has, 0.05 to 1, where it is known: 1 is a whole body. Else the network says.
    pub share: Option<f64>,
    /// Whether, where limbs in contact are told apart, the gradients that the network sees leave out edges between them too, as operator, basis and surface do. Off:
    /// the network was trained on gradients that know no parts, and on 12 pairs of the generator's held-out bodies as clouds (of 24, seeds from 900001)
    /// matches have 3.35 with it and 3.30 without (×100/√area). For measurements; not an option of the package.
    #[serde(skip)]
    pub part_aware_gradients: bool,
    /// What the scan is called, such as its file's name; [`Info::name`](super::Info) repeats it.
    #[serde(skip)]
    pub name: Option<String>,
    /// Hears of progress and may stop the call.
    #[serde(skip)]
    pub progress: Listener,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        Self {
            points: 5000,
            faces: FaceUse::Use,
            laplacian: None,
            eigenpairs: 120,
            up: None,
            whole_scan: false,
            share: None,
            part_aware_gradients: false,
            name: None,
            progress: Listener::default(),
        }
    }
}

impl PrepareOptions {
    /// Fewest points and eigenpairs that make a map, and the most that can be meant.
    pub fn check(&self) -> Result<(), OptionError> {
        if !(50..=2_000_000).contains(&self.points) {
            return Err(OptionError::out_of_range("points", self.points, "between 50 and 2000000"));
        }
        if !(10..=1000).contains(&self.eigenpairs) {
            return Err(OptionError::out_of_range("eigenpairs", self.eigenpairs, "between 10 and 1000"));
        }
        if let Some(share) = self.share.filter(|share| !(LEAST..=1.0).contains(share)) {
            return Err(OptionError::out_of_range("share", share, "between 0.05 and 1"));
        }
        Ok(())
    }
}

/// Whether the faces of a scan count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FaceUse {
    /// Faces make it a mesh.
    #[default]
    Use,
    /// Faces are dropped first; what is left is a cloud.
    Ignore,
}

/// Options of [`Matcher::match_shapes`](crate::Matcher::match_shapes).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
pub struct MatchOptions {
    /// Which part labels keep points of different parts apart.
    pub parts: Parts,
    /// How far the first map is polished.
    pub refine: Refinement,
    /// Pairs (uploaded index on A, uploaded index on B) known to correspond. They hold in every round and in the result, draw along what lies around them, and choose
    /// between maps.
    pub landmarks: Vec<[u32; 2]>,
    /// Hears of progress and may stop the call.
    #[serde(skip)]
    pub progress: Listener,
    /// Whether the match before refinement is kept beside the refined one, for measurements; not an option of the package.
    #[serde(skip)]
    pub raw: bool,
    /// Whether the network's map stands, where one made without it would compete otherwise; for measurements too.
    #[serde(skip)]
    pub network_only: bool,
}

/// Where part labels come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Parts {
    /// Predicted by the network, as a soft mask.
    #[default]
    Predicted,
    /// Labels that came with both scans: the point map stays within them wherever the other scan has the label near. The first map and attention know up to 64 of them apart, the largest.
    Given,
    /// None.
    None,
}

/// Nothing is taken for less of a body than this.
pub(super) const LEAST: f64 = 0.05;

/// An option that has no meaning here.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct OptionError {
    code: &'static str,
    message: String,
    details: Value,
}

impl OptionError {
    /// Not understood at all: a wrong name, type or value.
    pub fn invalid(reason: impl Into<String>) -> Self {
        Self { code: "invalid-option", message: reason.into(), details: json!({}) }
    }

    pub(crate) fn out_of_range(option: &str, value: impl Display + Into<Value>, range: &str) -> Self {
        Self {
            code: "invalid-option",
            message: format!("{option} must be {range}, and {value} was asked for"),
            details: json!({ "option": option, "value": value.into() }),
        }
    }

    pub(crate) fn no_labels(scan: &str) -> Self {
        Self {
            code: "no-labels",
            message: format!("parts are to be as given, but scan {scan} came without labels"),
            details: json!({ "scan": scan }),
        }
    }

    /// A scan that other weights looked at than those that are to match it.
    pub(crate) fn other_weights(scan: &str, prepared: &[&WeightsId], loaded: &[&WeightsId]) -> Self {
        let names = |ids: &[&WeightsId]| ids.iter().map(|id| id.to_string()).collect::<Vec<_>>().join(", ");
        Self {
            code: "other-weights",
            message: format!(
                "scan {scan} was prepared with the weights {}, and those loaded are {}: prepare it again",
                names(prepared),
                names(loaded)
            ),
            details: json!({ "scan": scan, "prepared": prepared, "loaded": loaded }),
        }
    }

    /// `a` and `b` are labels of the two scans, for example.
    pub(crate) fn no_shared_labels(a: u32, b: u32) -> Self {
        Self {
            code: "no-shared-labels",
            message: format!(
                "parts are to be as given, but no label of scan A (such as {a}) occurs on scan B (which has {b})"
            ),
            details: json!({ "a": a, "b": b }),
        }
    }

    pub(crate) fn landmark(index: u32, scan: &str, points: usize) -> Self {
        Self {
            code: "invalid-option",
            message: format!("landmark index {index} is not a point of scan {scan}, which has {points}"),
            details: json!({ "index": index, "scan": scan, "points": points }),
        }
    }

    pub(crate) fn landmark_twice(index: u32, scan: &str) -> Self {
        Self {
            code: "invalid-option",
            message: format!("landmarks give point {index} of scan {scan} two partners"),
            details: json!({ "index": index, "scan": scan }),
        }
    }

    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// The numbers behind the sentence.
    pub fn details(&self) -> Value {
        self.details.clone()
    }
}
