//! What a pair of 5000 points asks of a GPU, stage by stage, from the device's own counters: work, not time.
//!
//! ```text
//! cargo bench --features gpu --bench gpu_work > benches/results/gpu-work.md
//! ```

use std::cell::RefCell;

use geose_fmap::device::{Gpu, GpuCounters, GpuOptions};
use geose_fmap::network::Model;
use geose_fmap::pipeline::{match_with, prepare_with};
use geose_fmap::{FaceUse, MatchOptions, PrepareOptions, PreparedShape, Progress, Stage, read};
use pollster::block_on;

/// What the data sheets of a middling card of 2024 say: f32 operations and bytes of its memory per second, and bytes over its bus.
const FLOPS: f64 = 10e12;
const MEMORY: f64 = 250e9;
const BUS: f64 = 12e9;

const SAMPLES: [&[u8]; 2] = [
    include_bytes!("../www/public/samples/woman-standing.ply"),
    include_bytes!("../www/public/samples/man-lunging.ply"),
];

/// Counters of each stage in the order of their coming.
struct Stages<'g> {
    gpu: &'g Gpu,
    since: GpuCounters,
    now: Option<Stage>,
    done: Vec<(Stage, GpuCounters)>,
}

impl Stages<'_> {
    fn at(&mut self, stage: Option<Stage>) {
        if stage == self.now {
            return;
        }
        let counters = self.gpu.counters();
        if let Some(before) = self.now {
            self.done.push((before, counters - self.since));
        }
        (self.now, self.since) = (stage, counters);
    }
}

/// Runs `work` and tells what each of its stages asked of the GPU.
fn staged<T>(gpu: &Gpu, work: impl FnOnce(&mut Progress) -> T) -> (T, Vec<(Stage, GpuCounters)>) {
    let stages = RefCell::new(Stages { gpu, since: gpu.counters(), now: None, done: Vec::new() });
    let result = work(&mut Progress::new(|stage, _| {
        stages.borrow_mut().at(Some(stage));
        true
    }));
    let mut stages = stages.into_inner();
    stages.at(None);
    (result, stages.done)
}

/// One line of the table; the seconds that it takes at the least.
fn row(what: &str, done: GpuCounters) -> f64 {
    let [flops, touched, moved] =
        [done.flops as f64, done.bytes_touched as f64, (done.bytes_up + done.bytes_down) as f64];
    let bounds = [("arithmetic", flops / FLOPS), ("memory", touched / MEMORY), ("bus", moved / BUS)];
    let (bound, least) = bounds.into_iter().fold(("–", 0.0), |most, next| if next.1 > most.1 { next } else { most });
    let [arithmetic, memory, bus] = bounds.map(|(_, seconds)| 1e3 * seconds);
    println!(
        "| {what} | {} | {} ({:.1} MB) | {} ({:.1} MB) | {:.2} | {:.2} | {arithmetic:.2} | {memory:.2} | {bus:.2} | {bound} |",
        done.dispatches,
        done.uploads,
        done.bytes_up as f64 / 1e6,
        done.downloads,
        done.bytes_down as f64 / 1e6,
        flops / 1e9,
        touched / 1e9,
    );
    least
}

fn main() {
    let gpu = block_on(Gpu::new(GpuOptions { software: true })).expect("a GPU, which may be one in software");
    let model = Model::on(Model::embedded().weights().cloned(), gpu).expect("the weights that ship");
    println!(
        "# What a match asks of a GPU

`cargo bench --features gpu --bench gpu_work`: two sample bodies of 5000 points, k = 120, counted by the device itself. Bytes are those of every buffer that a shader
names, whole, once per dispatch: about what moves where caches are perfect. The bounds are milliseconds at the data sheet of a middling card ({} TFLOP/s in f32,
{} GB/s of memory, {} GB/s of bus). Nothing here was timed on such a card, and waiting for a download costs more than its bytes.
",
        FLOPS / 1e12,
        MEMORY / 1e9,
        BUS / 1e9
    );
    for (kind, faces) in [("meshes", FaceUse::Use), ("clouds", FaceUse::Ignore)] {
        println!(
            "## Two {kind}\n\n| stage | dispatches | uploads | downloads | GFLOP | GB | arithmetic, ms | memory, ms | bus, ms | bound by |\n|---|---|---|---|---|---|---|---|---|---|"
        );
        let options = PrepareOptions { faces, ..PrepareOptions::default() };
        let (mut total, mut least) = (model.device().counters(), 0.0);
        let mut shapes: Vec<PreparedShape> = Vec::new();
        for (name, bytes) in ["A", "B"].into_iter().zip(SAMPLES) {
            let scan = read(bytes, None, None).expect("a scan");
            let (shape, stages) = staged(model.device(), |progress| {
                block_on(prepare_with(&model, scan, None, &options, progress)).expect("prepared")
            });
            for (stage, done) in stages.into_iter().filter(|(_, done)| done.dispatches > 0) {
                least += row(&format!("{} of {name}", stage.name()), done);
            }
            shapes.push(shape);
        }
        let (_, stages) = staged(model.device(), |progress| {
            block_on(match_with(&model, &shapes[0], &shapes[1], &MatchOptions::default(), progress)).expect("matched")
        });
        for (stage, done) in stages {
            least += row(stage.name(), done);
        }
        total = model.device().counters() - total;
        row("together", total);
        println!(
            "\nStage by stage at least {:.0} ms of work, and {} downloads to wait for: where each is a round trip of a millisecond, waiting for them bounds the whole more than \
             any shader does.\n",
            1e3 * least,
            total.downloads
        );
    }
}
