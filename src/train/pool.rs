//! The scans that training draws from: made once, kept on disk, the same for every run of a seed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread;
use std::time::Duration;
use std::{fs, io};

use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::atlas::Atlas;
use super::bodies::held_out::HELD_OUT_SEEDS;
use super::bodies::scan::ScanOptions;
use super::bodies::shape_mixture::Person;
use super::bodies::style::Style;
use super::bodies::{BodyModel, Template};
use super::sample::Sample;
use super::sample_config::{SampleConfig, Stand};
use crate::network::Category;
use crate::operators::LaplacianKind;

/// Vertices of the meshes that are matched to the atlas.
pub const ATLAS_POINTS: usize = 4000;

/// Where there are pieces among the scans: the share of scans whose inputs say how large the whole body is, and the logarithm that this is off by at most.
const KNOWN_EXTENT: f64 = 0.6;
const EXTENT_OFF: f64 = 0.15;

/// A folder of samples, `count` of them, being filled from the front.
pub struct Pool {
    folder: PathBuf,
    /// How many there will be.
    pub count: usize,
    /// The kind of body.
    pub category: Category,
    /// How many of them, one after the other, are of one body.
    per_body: usize,
    /// Why no more are made, once that is so.
    failure: OnceLock<String>,
}

/// What makes samples, each from its place in the pool.
pub trait MakesSamples: Sync {
    /// Sample `index`, or why there is none.
    fn make(&self, index: usize) -> Result<Sample, String>;
}

/// What samples are made from.
pub struct Maker<'a> {
    /// The generator.
    pub model: &'a BodyModel,
    /// Its mesh.
    pub template: &'a Template,
    /// Where points are placed, if they are.
    pub atlas: Option<&'a Atlas>,
    /// How.
    pub config: &'a SampleConfig,
    /// Bodies of which more scans may follow, by seed.
    bodies: Mutex<BTreeMap<u64, Arc<Body>>>,
}

/// The fine skin of a body in metres, and where its vertices lie on the atlas.
struct Body {
    skin: Vec<DVec3>,
    places: Option<Vec<[f32; 3]>>,
}

/// Bodies that are kept: makers work on indices that follow one another.
const KEPT: usize = 4;

impl Pool {
    /// In `folder`, which is made where it is missing. A folder of samples that were made otherwise is refused.
    pub fn open(folder: &Path, count: usize, config: &SampleConfig) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let file = folder.join("samples.json");
        match fs::read(&file) {
            Ok(bytes) if serde_json::from_slice::<SampleConfig>(&bytes).is_ok_and(|made| made == *config) => {}
            Ok(_) => {
                let message = format!("{} has samples of other settings: name another folder", folder.display());
                return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
            }
            Err(_) => fs::write(file, serde_json::to_vec_pretty(config)?)?,
        }
        Ok(Self {
            folder: folder.to_owned(),
            count,
            category: config.category.clone(),
            per_body: 1,
            failure: OnceLock::new(),
        })
    }

    /// Where so many samples, one after the other, are of one body.
    pub fn per_body(self, per_body: usize) -> Self {
        Self { per_body, ..self }
    }

    /// The body of sample `index`.
    pub fn body(&self, index: usize) -> usize {
        index / self.per_body
    }

    /// How many bodies there are.
    pub fn bodies(&self) -> usize {
        self.count.div_ceil(self.per_body)
    }

    fn path(&self, index: usize) -> PathBuf {
        self.folder.join(format!("{index:06}.sample"))
    }

    /// Sample `index`; waits until it was made, unless making one has failed.
    pub fn get(&self, index: usize) -> io::Result<Sample> {
        let path = self.path(index);
        for _ in 0..36_000 {
            if path.exists() {
                return Sample::load(&path);
            }
            self.check()?;
            thread::sleep(Duration::from_millis(50));
        }
        Err(io::Error::new(io::ErrorKind::TimedOut, format!("{} was not made within half an hour", path.display())))
    }

    /// Fails once a sample could not be made.
    pub fn check(&self) -> io::Result<()> {
        self.failure.get().map_or(Ok(()), |failure| Err(io::Error::other(failure.clone())))
    }

    /// Makes what is missing, in order, on the threads that call; `next` is where they agree on who makes what. The first failure ends all of them.
    pub fn fill(&self, maker: &impl MakesSamples, next: &AtomicUsize, stop: &AtomicBool) {
        let _told = Unwinding(&self.failure);
        while !stop.load(Ordering::Relaxed) && self.failure.get().is_none() {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= self.count {
                return;
            }
            if self.path(index).exists() {
                continue;
            }
            let path = self.path(index);
            let save = |sample: Sample| sample.save(&path).map_err(|error| format!("{}: {error}", path.display()));
            if let Err(failure) = maker.make(index).and_then(save) {
                eprintln!("{failure}");
                let _ = self.failure.set(failure);
            }
        }
    }
}

/// Says that a maker panicked to who waits for its sample.
struct Unwinding<'a>(&'a OnceLock<String>);

impl Drop for Unwinding<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            let _ = self.0.set("a thread that made samples panicked".to_owned());
        }
    }
}

impl MakesSamples for Maker<'_> {
    /// For a body that cannot be used another one of a seed that no index has.
    fn make(&self, index: usize) -> Result<Sample, String> {
        for seed in (index as u64..HELD_OUT_SEEDS).step_by(HELD_OUT_SEEDS as usize / 8) {
            match self.sample(seed) {
                Ok(sample) => return Ok(sample),
                Err(error) => eprintln!("body {seed}: {error}"),
            }
        }
        Err(format!("no body could be used for sample {index}"))
    }
}

impl<'a> Maker<'a> {
    /// From bodies of the generator, and its mesh, as `config` says; points are placed where there is an `atlas`.
    pub fn new(
        model: &'a BodyModel,
        template: &'a Template,
        atlas: Option<&'a Atlas>,
        config: &'a SampleConfig,
    ) -> Self {
        Self { model, template, atlas, config, bodies: Mutex::default() }
    }

    /// The sample of a seed: a scan of a random body with the operator that such a scan would get, or for a part of the clouds another one, because
    /// weights trained on one operator alone fail on others.
    pub fn sample(&self, seed: u64) -> Result<Sample, String> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // Another stream than the one the scan is drawn from.
        rng.set_stream(1);
        // Different numbers of points, independently for the two shapes of a pair.
        let spread = self.config.spread;
        let points = (self.config.points as f64 * ((1.0 - spread) + 2.0 * spread * rng.random::<f64>())) as usize;
        let options = match self.config.stand {
            Stand::Random => ScanOptions { points, pieces: self.config.pieces, ..ScanOptions::default() },
            Stand::Alike => ScanOptions { points, mirrored: 0.0, moved: false, ..ScanOptions::default() },
        };
        // Of the truth nothing but the surface behind each point, to find the place of that surface, and how much of the body is there, which is known of whatever is cut.
        let body = self.body(seed / self.config.scans_of_body.max(1) as u64)?;
        let (scan, behind) = self.model.scan_of_seed(&body.skin, seed, &options).map_err(|error| error.to_string())?;
        let of = |places: &Vec<[f32; 3]>| behind.skin.iter().map(|&v| places[v as usize]).collect();
        let places: Option<Vec<[f32; 3]>> = body.places.as_ref().map(of);
        let kind = match rng.random::<f64>() {
            _ if !scan.shape.faces().is_empty() => None,
            _ if self.config.laplacian.is_some() => self.config.laplacian,
            x if x < 0.12 => Some(LaplacianKind::Euclidean),
            x if x < 0.2 => Some(LaplacianKind::GeodesicLiteral),
            _ => None,
        };
        // How much of a body is there is found in two steps: its parts are seen as if it were all, and then at the size that they tell.
        let extent = match self.config.pieces > 0.0 && rng.random::<f64>() < KNOWN_EXTENT {
            true => behind.share.sqrt() * (EXTENT_OFF * (2.0 * rng.random::<f64>() - 1.0)).exp(),
            false => 1.0,
        };
        Sample::of_piece(scan.shape, places.as_deref(), kind, [behind.share, extent], self.config)
            .map_err(|error| error.to_string())
    }

    /// The body of a seed, on the atlas by what a clean mesh of it says of the vertices of its fine skin.
    fn body(&self, seed: u64) -> Result<Arc<Body>, String> {
        let known = |bodies: &BTreeMap<u64, Arc<Body>>| bodies.get(&seed).cloned();
        if let Some(body) = self.bodies.lock().ok().and_then(|bodies| known(&bodies)) {
            return Ok(body);
        }
        let style = Style::of_seed(seed, self.config.stylised);
        let drawn = self.model.styled_body(self.template, seed, style).map_err(|error| error.to_string())?;
        let skin = drawn.skin;
        // What the teacher knows are people: a stylised body lies where the person does whom it was made from.
        let person = Person { style: Style::default(), ..drawn.person };
        let unstyled = (style != Style::default()).then(|| -> Result<Vec<DVec3>, String> {
            let rest = self.model.rest(&person).map_err(|error| error.to_string())?;
            Ok(self.model.posed(&rest, &drawn.turns).skin)
        });
        let people = unstyled.transpose()?;
        let placed = |atlas: &Atlas| -> Result<Vec<[f32; 3]>, String> {
            let people = people.as_ref().unwrap_or(&skin);
            let (mesh, cell) = self.model.clean_scan(people, ATLAS_POINTS).map_err(|error| error.to_string())?;
            let places = atlas.places(mesh).map_err(|error| error.to_string())?;
            Ok(cell.iter().map(|&v| places[v as usize]).collect())
        };
        let places = self.atlas.map(placed).transpose()?;
        let body = Arc::new(Body { skin, places });
        if let Ok(mut bodies) = self.bodies.lock() {
            bodies.insert(seed, body.clone());
            if bodies.len() > KEPT {
                bodies.pop_first();
            }
        }
        Ok(body)
    }
}
