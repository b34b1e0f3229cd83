//! Sparse factorisation of L + shift·M, to solve with it and to count eigenvalues by it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::simplicial::SimplicialLdltRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{ColRef, Conj, MatMut, Par, Side};
use sprs::CsMat;

/// L, M and the elimination order they share for every shift.
pub(crate) struct Pencil<'l> {
    matrix: &'l CsMat<f64>,
    mass: &'l [f64],
    indptr: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
}

/// L + shift·M = P L̂ D L̂ᵀ Pᵀ.
pub(crate) struct Factor<'p> {
    symbolic: &'p SymbolicCholesky<usize>,
    values: Vec<f64>,
    buffer: MemBuffer,
}

impl<'l> Pencil<'l> {
    /// Orders the unknowns (approximate minimum degree). `None` when memory for it cannot be had.
    pub(crate) fn new(matrix: &'l CsMat<f64>, mass: &'l [f64]) -> Option<Self> {
        let n = mass.len();
        let indptr = matrix.indptr().raw_storage().to_vec();
        let structure = SymbolicSparseColMatRef::new_checked(n, n, &indptr, None, matrix.indices());
        let symbolic = factorize_symbolic_cholesky(
            structure,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        Some(Self { matrix, mass, indptr, symbolic })
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.mass.len()
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
        Some(Factor { symbolic: &self.symbolic, values, buffer: MemBuffer::new(faer::dyn_stack::StackReq::EMPTY) })
    }
}

impl Factor<'_> {
    /// Solves in place for the columns of `rhs` (n, b).
    pub(crate) fn solve(&mut self, rhs: MatMut<'_, f64>) {
        let needed = self.symbolic.solve_in_place_scratch::<f64>(rhs.ncols(), Par::Seq);
        if self.buffer.len() < needed.unaligned_bytes_required() {
            self.buffer = MemBuffer::new(needed);
        }
        let factor = LdltRef::new(self.symbolic, &self.values);
        factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut self.buffer));
    }

    /// Negative pivots: by Sylvester's law of inertia, the number of eigenvalues of (L, M) below −shift.
    pub(super) fn negative_pivots(&self) -> usize {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let values = SimplicialLdltRef::new(symbolic, &self.values).values();
                symbolic.col_ptr()[..symbolic.ncols()].iter().filter(|&&start| values[start] < 0.0).count()
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLdltRef::new(symbolic, &self.values);
                (0..symbolic.n_supernodes())
                    .map(|s| {
                        let width = symbolic.supernode_end()[s] - symbolic.supernode_begin()[s];
                        let block = factor.supernode(s).val();
                        (0..width).filter(|&i| block[(i, i)] < 0.0).count()
                    })
                    .sum()
            }
        }
    }
}
