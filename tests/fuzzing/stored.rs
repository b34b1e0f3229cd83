//! Stored prepared shapes: any bytes, and good ones with changes that leave them safetensors.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

use arbitrary::{Result, Unstructured};
use geose_fmap::{MatchOptions, PreparedShape};
use safetensors::tensor::{Dtype, SafeTensors, View, serialize};

use super::memory::peak_of;
use super::scans::{SPECIAL, TORI, matches};

/// Unpacks; what can be unpacked can be stored again and matched.
pub fn survives(bytes: &[u8]) {
    let (unpacked, peak) = peak_of(|| PreparedShape::from_bytes(bytes));
    assert!(peak <= (1 << 20) + 64 * bytes.len(), "{peak} bytes held for {} bytes", bytes.len());
    match unpacked {
        Ok(shape) => {
            let again = shape.to_bytes().expect("what was unpacked can be stored");
            assert!(PreparedShape::from_bytes(&again).is_ok(), "stored once more it is refused");
            matches(&shape, &MatchOptions::default());
        }
        Err(error) => assert!(error.to_string().len() < 1000),
    }
}

/// A tensor with bytes of its own.
#[derive(Clone)]
pub struct Tensor {
    dtype: Dtype,
    pub shape: Vec<usize>,
    pub bytes: Vec<u8>,
}

impl View for &Tensor {
    fn dtype(&self) -> Dtype {
        self.dtype
    }

    fn shape(&self) -> &[usize] {
        &self.shape
    }

    fn data(&self) -> Cow<'_, [u8]> {
        self.bytes.as_slice().into()
    }

    fn data_len(&self) -> usize {
        self.bytes.len()
    }
}

/// The tensors and texts of a stored shape.
pub struct Block {
    pub tensors: BTreeMap<String, Tensor>,
    texts: BTreeMap<String, String>,
}

impl Block {
    pub fn of(bytes: &[u8]) -> Self {
        let (_, header) = SafeTensors::read_metadata(bytes).expect("a stored shape");
        let block = SafeTensors::deserialize(bytes).expect("a stored shape");
        let tensors = block.tensors().into_iter().map(|(name, view)| {
            (name, Tensor { dtype: view.dtype(), shape: view.shape().to_vec(), bytes: view.data().to_vec() })
        });
        let texts = header.metadata().clone().unwrap_or_default().into_iter();
        Self { tensors: tensors.collect(), texts: texts.collect() }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let texts: HashMap<String, String> = self.texts.clone().into_iter().collect();
        serialize(self.tensors.iter(), Some(texts)).expect("tensors can be stored")
    }

    /// One change of a number, a length, a tensor or a text.
    fn change(&mut self, u: &mut Unstructured, other: &Block) -> Result<()> {
        let names: Vec<String> = self.tensors.keys().cloned().collect();
        let Some(name) = names.get(u.int_in_range(0..=names.len().max(1) - 1)?) else { return Ok(()) };
        let tensor = self.tensors.get_mut(name).expect("a tensor of this name");
        match u.int_in_range(0..=6)? {
            0..=2 => {
                let size = if tensor.dtype == Dtype::F64 {
                    8
                } else if tensor.dtype == Dtype::U8 {
                    1
                } else {
                    4
                };
                let count = tensor.bytes.len() / size;
                let from = u.int_in_range(0..=count.max(1) - 1)?;
                let (to, special) = (if u.arbitrary()? { from + 1 } else { count }, *u.choose(&SPECIAL)?);
                let whole = *u.choose(&[0, 1, 11, 63, 64, 1000, u32::MAX, i32::MAX as u32])?;
                let value = match tensor.dtype {
                    Dtype::F64 => special.to_le_bytes().to_vec(),
                    Dtype::F32 => (special as f32).to_le_bytes().to_vec(),
                    Dtype::U8 => vec![whole as u8],
                    _ => whole.to_le_bytes().to_vec(),
                };
                tensor.bytes.chunks_exact_mut(size).take(to).skip(from).for_each(|place| place.copy_from_slice(&value));
            }
            3 => {
                let rows = u.int_in_range(0..=tensor.shape.first().copied().unwrap_or(0))?;
                let width = tensor.bytes.len() / tensor.shape.first().copied().unwrap_or(1).max(1);
                tensor.bytes.truncate(rows * width);
                if let Some(first) = tensor.shape.first_mut() {
                    *first = rows;
                }
            }
            4 => match other.tensors.get(name) {
                Some(tensor) if u.arbitrary()? => drop(self.tensors.insert(name.clone(), tensor.clone())),
                _ => drop(self.tensors.remove(name)),
            },
            5 => {
                // Under another's name, such as one that only some shapes have.
                let optional = [
                    "labels",
                    "carriers",
                    "carrierOf",
                    "used",
                    "usedOf",
                    "unmatched",
                    "standsFor",
                    "placeless",
                    "added",
                    "resampledFaces",
                ];
                let tensor = tensor.clone();
                self.tensors.insert((*u.choose(&optional)?).to_owned(), tensor);
            }
            _ => {
                let keys: Vec<String> = self.texts.keys().cloned().collect();
                let text = self.texts.get_mut(u.choose(&keys)?).expect("a text of this name");
                let at = u.int_in_range(0..=text.len())?;
                let end = (at + u.int_in_range(0..=8)?).min(text.len());
                let piece =
                    *u.choose(&["", "0", "-1", "1e308", "null", "[]", "{}", "\"", "4294967296", ",", "true"])?;
                if text.is_char_boundary(at) && text.is_char_boundary(end) {
                    text.replace_range(at..end, piece);
                }
            }
        }
        Ok(())
    }
}

/// The stored torus that bytes stand for.
fn edited(u: &mut Unstructured) -> Result<Vec<u8>> {
    let mut blocks = TORI.each_ref().map(|torus| Block::of(&torus.to_bytes().expect("a torus is stored")));
    if u.arbitrary()? {
        blocks.reverse();
    }
    let [mut block, other] = blocks;
    for _ in 0..8 {
        if u.is_empty() {
            break;
        }
        block.change(u, &other)?;
    }
    Ok(block.bytes())
}

/// The same as [`survives`] for a good shape with changes that the bytes stand for.
pub fn survives_edits(bytes: &[u8]) {
    if let Ok(bytes) = edited(&mut Unstructured::new(bytes)) {
        survives(&bytes);
    }
}

/// A torus as it is stored, as a mesh and as a cloud.
pub fn seeds() -> Vec<Vec<u8>> {
    TORI.iter().map(|torus| torus.to_bytes().expect("a torus is stored")).collect()
}
