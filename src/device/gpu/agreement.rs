//! Every kernel against its twin on the CPU, on the same numbers.

use ndarray::{Array2, ArrayView2};

use super::nearest_rows::TILE;
use super::{Gpu, GpuTensor};
use crate::device::{Cpu, Device, Mask};

/// How far a kernel's results are from those of the CPU.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// What was computed.
    pub kernel: &'static str,
    /// The largest difference, relative to the largest value; of nearest rows, in squares of distances relative to squares of lengths.
    pub error: f64,
    /// What is to be expected of f32 sums in another order, and of exponentials that may be some bits off.
    pub tolerance: f64,
}

impl Agreement {
    /// Whether the results are as good as the CPU's.
    pub fn holds(&self) -> bool {
        self.error <= self.tolerance
    }
}

/// Columns: of no size that a tile divides.
const COLUMNS: usize = 37;
const WIDE: usize = 131;
const UNKNOWNS: usize = 21;
const PART_COUNT: usize = 5;
/// As many keys as matching uses, less one.
const KEYS: usize = 1023;
/// Rows of a product that is shared out.
const LONG: usize = 600;
/// Rows of the self-test: more than a tile.
const SELF_TEST: usize = 65;

/// Matrices with values in (−1, 1), the same every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        // Steele & Vigna's constant; the upper bits of a linear congruence are random enough.
        self.0 = self.0.wrapping_mul(0xd134_2543_de82_ef95).wrapping_add(1);
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn matrix(&mut self, rows: usize, cols: usize, scale: f32) -> Array2<f32> {
        Array2::from_shape_simple_fn((rows, cols), || scale * self.next())
    }

    /// Rows that sum to 1; every third is certain of its part.
    fn probabilities(&mut self, rows: usize) -> Array2<f32> {
        let mut parts = self.matrix(rows, PART_COUNT, 1.0).mapv_into(f32::abs);
        for (i, mut row) in parts.rows_mut().into_iter().enumerate() {
            if i % 3 == 0 {
                row.fill(0.0);
                row[i % PART_COUNT] = 1.0;
            }
            let sum = row.sum();
            row /= sum;
        }
        parts
    }
}

/// Labels of which one has one row on either side, and `alone` one that the other side does not have.
fn labels(rows: usize, alone: u32) -> Vec<u32> {
    (0..rows)
        .map(|i| match i {
            0 => 99,
            1 => alone,
            _ => (i * i % PART_COUNT) as u32,
        })
        .collect()
}

/// What a kernel gave, beside what it should have given.
struct Comparison<'a> {
    gpu: &'a Gpu,
    results: Vec<Agreement>,
}

impl Comparison<'_> {
    async fn matrix(&mut self, kernel: &'static str, tolerance: f64, expected: Array2<f32>, found: &GpuTensor) {
        let found = self.gpu.download(found).await;
        let largest = expected.iter().fold(f64::MIN_POSITIVE, |most, v| most.max(f64::from(v.abs())));
        let error = if found.dim() == expected.dim() {
            let differences = found.iter().zip(&expected).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
            // NaN is no agreement.
            differences.fold(0.0, |most, d| if d <= most { most } else { d }) / largest
        } else {
            f64::INFINITY
        };
        self.push(kernel, error, tolerance);
    }

    /// Neighbours may differ where two are equally near to within rounding.
    fn neighbours(
        &mut self,
        kernel: &'static str,
        x: ArrayView2<f32>,
        y: ArrayView2<f32>,
        expected: &[u32],
        found: &[u32],
    ) {
        let longest = |a: ArrayView2<f32>| a.rows().into_iter().map(|row| square(row.iter())).fold(0.0, f64::max);
        let scale = (longest(x) + longest(y)).max(f64::MIN_POSITIVE);
        let distance = |i: usize, j: u32| {
            let differences: Vec<f32> = x.row(i).iter().zip(y.row(j as usize)).map(|(a, b)| a - b).collect();
            square(differences.iter())
        };
        let sound = found.len() == expected.len() && found.iter().all(|&j| (j as usize) < y.nrows().max(1));
        let error = match sound {
            true if y.nrows() > 0 => (0..)
                .zip(found.iter().zip(expected))
                .map(|(i, (&a, &b))| (distance(i, a) - distance(i, b)).abs() / scale)
                .fold(0.0, f64::max),
            true => 0.0,
            false => f64::INFINITY,
        };
        self.push(kernel, error, 2e-6);
    }

    fn push(&mut self, kernel: &'static str, error: f64, tolerance: f64) {
        self.results.push(Agreement { kernel, error, tolerance });
    }
}

fn square<'a>(row: impl Iterator<Item = &'a f32>) -> f64 {
    row.map(|&v| f64::from(v) * f64::from(v)).sum()
}

impl Gpu {
    /// Runs every kernel on matrices of `rows` rows with values up to `scale`, between 1e-15 and 1e15, here and on the CPU.
    pub async fn agreement(&self, rows: usize, scale: f32) -> Vec<Agreement> {
        let mut numbers = Numbers(rows as u64 ^ u64::from(scale.to_bits()) << 32);
        let mut to = Comparison { gpu: self, results: Vec::new() };
        let up = |matrix: &Array2<f32>| self.upload(matrix.view());

        let (x, z) = (numbers.matrix(rows, COLUMNS, scale), numbers.matrix(rows, COLUMNS, scale));
        let (weight, bias) = (numbers.matrix(COLUMNS, WIDE, 1.0), numbers.matrix(1, WIDE, scale));
        let few = numbers.matrix(UNKNOWNS, COLUMNS, 1.0);
        let (on_x, on_z, on_weight, on_bias, on_few) = (up(&x), up(&z), up(&weight), up(&bias), up(&few));
        to.matrix("matmul", 1e-5, Cpu.matmul(&x, &weight), &self.matmul(&on_x, &on_weight)).await;
        to.matrix("matmul_tn", 1e-5, Cpu.matmul_tn(&x, &z), &self.matmul_tn(&on_x, &on_z)).await;
        to.matrix("matmul_nt", 1e-5, Cpu.matmul_nt(&x, &few), &self.matmul_nt(&on_x, &on_few)).await;
        to.matrix("linear", 1e-5, Cpu.linear(&x, &weight, &bias), &self.linear(&on_x, &on_weight, &on_bias)).await;

        // A long inner index is shared out, and the shares are summed.
        let (long, wide) = (numbers.matrix(LONG, UNKNOWNS, scale), numbers.matrix(LONG, COLUMNS, 1.0));
        to.matrix("sum", 1e-5, Cpu.matmul_tn(&long, &wide), &self.matmul_tn(&up(&long), &up(&wide))).await;

        let (gain, shift) = (numbers.matrix(1, COLUMNS, 1.0), numbers.matrix(1, COLUMNS, 1.0));
        let normal = self.layer_norm(&on_x, &up(&gain), &up(&shift));
        to.matrix("layer_norm", 1e-5, Cpu.layer_norm(&x, &gain, &shift), &normal).await;
        let (mean, variance) = (numbers.matrix(1, COLUMNS, scale), numbers.matrix(1, COLUMNS, 4.0).mapv_into(f32::abs));
        let normal = self.batch_norm(&on_x, (&up(&mean), &up(&variance)), &up(&gain), &up(&shift));
        to.matrix("batch_norm", 1e-5, Cpu.batch_norm(&x, (&mean, &variance), &gain, &shift), &normal).await;
        to.matrix("normalize_rows", 1e-6, Cpu.normalize_rows(&x), &self.normalize_rows(&on_x)).await;
        to.matrix("softmax_rows", 1e-5, Cpu.softmax_rows(&x), &self.softmax_rows(&on_x)).await;

        to.matrix("multiply", 0.0, Cpu.multiply(&x, &z), &self.multiply(&on_x, &on_z)).await;
        to.matrix("add", 1e-6, Cpu.add(&x, &z, -0.7), &self.add(&on_x, &on_z, -0.7)).await;
        to.matrix("relu", 0.0, Cpu.relu(&x), &self.relu(&on_x)).await;
        to.matrix("tanh", 1e-6, Cpu.tanh(&x), &self.tanh(&on_x)).await;
        let lambda = numbers.matrix(rows, 1, 300.0).mapv_into(f32::abs);
        let log_times = numbers.matrix(1, COLUMNS, 3.0) - 4.0;
        let diffused = self.diffuse(&on_x, &up(&lambda), &up(&log_times));
        to.matrix("diffuse", 1e-5, Cpu.diffuse(&x, &lambda, &log_times), &diffused).await;
        // Products of all pairs: of no more rows than moments have.
        let vectors = numbers.matrix(rows.min(UNKNOWNS), 3, scale);
        to.matrix("cross_pairs", 1e-6, Cpu.cross_pairs(&vectors), &self.cross_pairs(&up(&vectors))).await;

        let first = Cpu.leading_columns(&x, UNKNOWNS);
        let on_first = self.leading_columns(&on_x, UNKNOWNS);
        to.matrix("leading_columns", 0.0, first.clone(), &on_first).await;
        let beside = Cpu.concat(&[(&x, 1.0), (&first, 8.0), (&z, -0.3)]);
        to.matrix("concat", 0.0, beside, &self.concat(&[(&on_x, 1.0), (&on_first, 8.0), (&on_z, -0.3)])).await;

        // Scores so large that rounding decides which key is seen would be compared in vain.
        let (query, key) =
            (numbers.matrix(rows, COLUMNS, scale.min(4.0)), numbers.matrix(rows.min(KEYS), COLUMNS, 4.0));
        let (of_query, of_key) = (numbers.probabilities(rows), numbers.probabilities(key.nrows()));
        let value = numbers.matrix(key.nrows(), WIDE, scale);
        for (kernel, mask) in [("attend", Mask::Soft), ("attend within parts", Mask::Hard)] {
            let seen = self.attend((&up(&query), &up(&of_query)), (&up(&key), &up(&of_key)), &up(&value), mask);
            to.matrix(kernel, 1e-5, Cpu.attend((&query, &of_query), (&key, &of_key), &value, mask), &seen).await;
        }

        let systems = rows.min(2 * WIDE);
        let mask = numbers.matrix(systems, UNKNOWNS, scale).mapv_into(f32::abs) + 0.1 * scale;
        let gram = {
            let columns = numbers.matrix(2 * UNKNOWNS, UNKNOWNS, 1.0);
            Cpu.matmul_tn(&columns, &columns) * scale
        };
        let right = numbers.matrix(systems, UNKNOWNS, scale);
        let solved = self.solve_rows(&up(&gram), &up(&right), &up(&mask));
        to.matrix("solve_rows", 1e-4, Cpu.solve_rows(&gram, &right, &mask), &solved).await;

        // A third fewer rows on the other side, among them copies, of which the first is to be found.
        let mut y = numbers.matrix(rows.div_ceil(3) * 2, COLUMNS, scale);
        for i in (0..y.nrows().min(rows)).step_by(5) {
            y.row_mut(i).assign(&x.row(i));
        }
        let on_y = up(&y);
        let (to_y, to_x) = Cpu.nearest_rows(&x, &y, None);
        // In several dispatches, as large matrices are compared.
        let (on_to_y, on_to_x) = self.nearest_in_slabs(&on_x, &on_y, None, TILE);
        let (found_y, found_x) = (self.download_indices(&on_to_y).await, self.download_indices(&on_to_x).await);
        to.neighbours("nearest_rows", x.view(), y.view(), &to_y, &found_y);
        to.neighbours("nearest_rows back", y.view(), x.view(), &to_x, &found_x);
        to.matrix("gather", 0.0, Cpu.gather(&y, &found_y), &self.gather(&on_y, &on_to_y)).await;
        let (of_x, of_y) = (labels(rows, 50), labels(y.nrows(), 51));
        let (to_y, to_x) = Cpu.nearest_rows(&x, &y, Some((&of_x, &of_y)));
        let (on_to_y, on_to_x) = self.nearest_rows(&on_x, &on_y, Some((&of_x, &of_y)));
        let (found_y, found_x) = (self.download_indices(&on_to_y).await, self.download_indices(&on_to_x).await);
        to.neighbours("nearest_rows within parts", x.view(), y.view(), &to_y, &found_y);
        to.neighbours("nearest_rows within parts back", y.view(), x.view(), &to_x, &found_x);
        to.results
    }

    /// Whether this device computes what the CPU does, with every kernel; else the sentence that says what is wrong.
    pub async fn self_test(&self) -> Result<(), String> {
        let results = self.agreement(SELF_TEST, 1.0).await;
        if let Some(failure) = self.failure() {
            return Err(failure);
        }
        match results.iter().find(|result| !result.holds()) {
            None => Ok(()),
            Some(Agreement { kernel, error, tolerance }) => {
                Err(format!("{kernel} is {error:.1e} off on {}, where {tolerance:.0e} is expected", self.info().name))
            }
        }
    }
}
