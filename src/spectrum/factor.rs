//! Sparse factorisation of L + shift·M, to solve with it and to count eigenvalues by it.

use std::borrow::Cow;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{ColRef, MatMut, Par, Side};
use sprs::CsMat;

use super::sweeps::Sweeps;

/// L, M and the elimination order they share for every shift.
pub(crate) struct Pencil<'l> {
    matrix: Cow<'l, CsMat<f64>>,
    mass: Cow<'l, [f64]>,
    indptr: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
}

/// L + shift·M = P L̂ D L̂ᵀ Pᵀ.
pub(crate) struct Factor<'p> {
    symbolic: &'p SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// Once something has been solved.
    sweeps: Option<Sweeps>,
}

impl<'l> Pencil<'l> {
    /// Orders the unknowns (approximate minimum degree). `None` when memory for it cannot be had.
    pub(crate) fn new(matrix: Cow<'l, CsMat<f64>>, mass: Cow<'l, [f64]>) -> Option<Self> {
        let n = mass.len();
        let indptr = matrix.indptr().raw_storage().to_vec();
        let structure = SymbolicSparseColMatRef::new_checked(n, n, &indptr, None, matrix.indices());
        let symbolic = factorize_symbolic_cholesky(
            structure,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                // FORCE_SUPERNODAL is 0, which a matrix without an entry beside the diagonal does not exceed.
                supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
                ..Default::default()
            },
        )
        .ok()?;
        Some(Self { matrix, mass, indptr, symbolic })
    }

    /// Entries of a row beside the diagonal, on average.
    pub(super) fn neighbours(&self) -> f64 {
        self.matrix.nnz() as f64 / self.mass.len() as f64 - 1.0
    }

    /// ‖(M^−½LM^−½ − μ)x − y‖.
    pub(super) fn residual(&self, root_mass: &[f64], mu: f64, x: ColRef<'_, f64>, y: ColRef<'_, f64>) -> f64 {
        let squares = self.matrix.outer_iterator().enumerate().map(|(i, row)| {
            let product: f64 = row.iter().map(|(j, &value)| value * x[j] / root_mass[j]).sum();
            (product / root_mass[i] - mu * x[i] - y[i]).powi(2)
        });
        squares.sum::<f64>().sqrt()
    }

    /// Factors L + shift·M. `None` when a pivot vanishes or memory runs out.
    pub(super) fn factor(&self, shift: f64) -> Option<Factor<'_>> {
        self.factor_with(&self.mass.iter().map(|m| shift * m).collect::<Vec<f64>>())
    }

    /// Factors L + diag(`diagonal`), of which all entries (n) count. `None` when a pivot vanishes or memory runs out.
    pub(crate) fn factor_with(&self, diagonal: &[f64]) -> Option<Factor<'_>> {
        let n = self.mass.len();
        let mut shifted = self.matrix.data().to_vec();
        for (i, added) in diagonal.iter().enumerate() {
            let row = self.indptr[i]..self.indptr[i + 1];
            let slot = row.start + self.matrix.indices()[row].binary_search(&i).ok()?;
            shifted[slot] += added;
        }
        let structure = SymbolicSparseColMatRef::new_checked(n, n, &self.indptr, None, self.matrix.indices());
        let matrix = SparseColMatRef::new(structure, &shifted);
        let mut values = vec![0.0; self.symbolic.len_val()];
        let needed = self.symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let mut buffer = MemBuffer::try_new(needed).ok()?;
        self.symbolic
            .factorize_numeric_ldlt(
                &mut values,
                matrix,
                Side::Lower,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut buffer),
                Default::default(),
            )
            .ok()?;
        Some(Factor { symbolic: &self.symbolic, values, sweeps: None })
    }
}

impl Factor<'_> {
    /// Solves in place for the columns of `rhs` (n, b).
    pub(crate) fn solve(&mut self, rhs: MatMut<'_, f64>) {
        let sweeps = self.sweeps.get_or_insert_with(|| {
            let order = (0..self.symbolic.nrows()).map(|i| self.symbolic.perm().map_or(i, |perm| perm.arrays().0[i]));
            Sweeps::new(&supernodal(self.symbolic, &self.values), order)
        });
        sweeps.solve(rhs);
    }

    /// Negative pivots: by Sylvester's law of inertia, the number of eigenvalues of (L, M) below −shift.
    pub(super) fn negative_pivots(&self) -> usize {
        let factor = supernodal(self.symbolic, &self.values);
        let negative = |s: usize| {
            let block = factor.supernode(s).val();
            (0..block.ncols()).filter(|&i| block[(i, i)] < 0.0).count()
        };
        (0..factor.symbolic().n_supernodes()).map(negative).sum()
    }
}

fn supernodal<'a>(symbolic: &'a SymbolicCholesky<usize>, values: &'a [f64]) -> SupernodalLdltRef<'a, usize, f64> {
    match symbolic.raw() {
        SymbolicCholeskyRaw::Supernodal(symbolic) => SupernodalLdltRef::new(symbolic, values),
        SymbolicCholeskyRaw::Simplicial(_) => unreachable!("supernodes were asked for"),
    }
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use sprs::CsMat;

    use super::Pencil;

    #[test]
    fn a_matrix_without_an_entry_beside_the_diagonal_is_factored_too() {
        let pencil = Pencil::new(Cow::Owned(CsMat::eye(50)), Cow::Owned(vec![1.0; 50])).expect("a pencil");
        let mut factor = pencil.factor(1.0).expect("a factor");
        let mut right = faer::Mat::from_fn(50, 3, |i, _| i as f64);
        factor.solve(right.as_mut());
        assert!((0..50).all(|i| right[(i, 2)] == 0.5 * i as f64));
        assert_eq!(factor.negative_pivots(), 0);
        assert_eq!(pencil.factor(-2.0).expect("a factor").negative_pivots(), 50);
    }
}
