//! What kind of body a network knows is data: weights of another category work without a change of code, and several can stand beside each other.

mod shapes;

use std::collections::BTreeMap;
use std::sync::Arc;

use geose_fmap::network::Model;
use geose_fmap::pipeline::{DeviceChoice, Processor};
use geose_fmap::{Category, Match, MatchOptions, Matcher, PrepareOptions, PreparedShape, Progress, Shape, Weights};
use ndarray::{Array2, Axis};
use pollster::block_on;

use shapes::body;

fn embedded() -> &'static Weights {
    Model::embedded().networks()[0].weights()
}

/// A tensor of the weights that ship, for these of its parts in this order.
fn with_parts(name: &str, tensor: Array2<f32>, parts: &[usize]) -> Array2<f32> {
    let all = Model::embedded().networks()[0].category().parts.len();
    match name {
        "extent.points.weight" => {
            let width = tensor.nrows() - all;
            tensor.select(Axis(0), &(0..width).chain(parts.iter().map(|part| width + part)).collect::<Vec<_>>())
        }
        _ if name.starts_with("parts.") => tensor.select(Axis(1), parts),
        _ => tensor,
    }
}

/// The weights that ship under other names: parts in the opposite order, in another language, of another category.
fn renamed() -> Weights {
    let weights = embedded();
    let count = weights.category.parts.len();
    let mut text = weights.category.to_json().expect("JSON");
    for (english, german) in
        [("left ", "links "), ("right ", "rechts "), ("\"left\"", "\"links\""), ("\"right\"", "\"rechts\"")]
    {
        text = text.replace(english, german);
    }
    let category = Category::from_json(&text).expect("the same under other names");
    let mut json: serde_json::Value = serde_json::from_str(&category.to_json().expect("JSON")).expect("JSON");
    let reversed =
        |index: &serde_json::Value| serde_json::json!(count - 1 - index.as_u64().expect("an index") as usize);
    json["name"] = "Leute".into();
    json["one"] = "Mensch".into();
    let parts = json["parts"].as_array_mut().expect("parts");
    parts.reverse();
    parts.iter_mut().for_each(|part| part["mirror"] = reversed(&part["mirror"]));
    for key in ["meeting", "cues"] {
        let lists = json[key].as_array_mut().expect("lists");
        lists.iter_mut().flat_map(|list| list.as_array_mut().expect("a list")).for_each(|part| *part = reversed(part));
    }
    let category = Category::from_json(&json.to_string()).expect("sound");
    let turned = |name: &str, tensor: Array2<f32>| with_parts(name, tensor, &(0..count).rev().collect::<Vec<_>>());
    let tensors = weights.tensors().map(|(name, tensor)| (name.to_owned(), turned(name, tensor.to_owned())));
    let about = BTreeMap::from([("name".to_owned(), "Koerper".to_owned()), ("version".to_owned(), "7".to_owned())]);
    Weights::new(weights.config.clone(), category, about, tensors.collect())
}

/// Weights whose parts nobody can be sure of: all logits alike.
fn clueless() -> Weights {
    let weights = embedded();
    let zeroed = |name: &str, tensor: Array2<f32>| if name.starts_with("parts.") { tensor * 0.0 } else { tensor };
    let tensors = weights.tensors().map(|(name, tensor)| (name.to_owned(), zeroed(name, tensor.to_owned())));
    let about = BTreeMap::from([("name".to_owned(), "clueless".to_owned()), ("version".to_owned(), "1".to_owned())]);
    let mut category = weights.category.clone();
    category.name = "nobody".to_owned();
    Weights::new(weights.config.clone(), category, about, tensors.collect())
}

/// Weights that know three parts, without sides, cues, coefficients of confidence or a threshold: as they come from labelled scans of one's own.
fn unfitted() -> Weights {
    let weights = embedded();
    let part =
        |name: &str, mirror: usize, area: f64| serde_json::json!({ "name": name, "mirror": mirror, "area": area });
    let category = serde_json::json!({
        "name": "scans", "one": "scan", "version": 1, "meeting": [[0, 1], [1, 2]],
        "parts": [part("top", 0, 0.1), part("middle", 1, 0.5), part("bottom", 2, 0.4)],
        "thresholds": { "bijectivity": 0.2, "certainty": 0.0, "contact": 1.0 },
    });
    let category = Category::from_json(&category.to_string()).expect("a category");
    let three = |name: &str, tensor: Array2<f32>| with_parts(name, tensor, &[0, 1, 8]);
    let tensors = weights.tensors().map(|(name, tensor)| (name.to_owned(), three(name, tensor.to_owned())));
    let about = BTreeMap::from([("name".to_owned(), "own".to_owned()), ("version".to_owned(), "1".to_owned())]);
    Weights::new(weights.config.clone(), category, about, tensors.collect())
}

fn options() -> PrepareOptions {
    PrepareOptions { points: 1200, ..PrepareOptions::default() }
}

fn knowing<const N: usize>(weights: [Weights; N]) -> Matcher {
    Matcher::with_weights(weights).expect("networks")
}

fn prepared(matcher: &Matcher, shape: Shape) -> PreparedShape {
    matcher.prepare(shape, &options()).expect("prepared")
}

fn matched(matcher: &Matcher, a: &PreparedShape, b: &PreparedShape) -> Match {
    matcher.match_shapes(a, b, &MatchOptions::default()).expect("matched")
}

#[test]
fn renamed_parts_in_another_order_make_the_same_map_and_are_called_by_their_names() {
    let file = renamed().to_bytes(true).expect("bytes");
    let weights = Weights::from_bytes(&file).expect("read back");
    let (own, other) = (Matcher::new(), knowing([weights]));
    let bodies = || [body("woman-standing.ply"), body("man-lunging.ply")];
    let [of_own, of_other] = [&own, &other].map(|matcher| bodies().map(|shape| prepared(matcher, shape)));
    let (first, second) = (matched(&own, &of_own[0], &of_own[1]), matched(&other, &of_other[0], &of_other[1]));
    assert_eq!(first.a_to_b.target, second.a_to_b.target);
    assert_eq!((first.category.as_deref(), second.category.as_deref()), (Some("people"), Some("Leute")));
    assert_eq!(second.weights.as_ref().map(|id| (id.name.as_str(), id.version.as_str())), Some(("Koerper", "7")));
    let same = first.a_to_b.confidence.iter().zip(&second.a_to_b.confidence);
    assert!(same.clone().all(|(x, y)| (x - y).abs() < 1e-4));
    assert_eq!((of_own[0].info.unit.as_deref(), of_other[0].info.unit.as_deref()), (Some("m"), Some("m")));
    let named = |shape: &PreparedShape| {
        let names: Vec<String> = shape.category().expect("one").part_names().iter().map(|n| n.to_string()).collect();
        let parts = shape.predicted_parts().expect("parts");
        parts.into_iter().map(|part| names[part as usize].clone()).collect::<Vec<String>>()
    };
    let english = |name: String| name.replace("links ", "left ").replace("rechts ", "right ");
    assert_eq!(named(&of_own[0]), named(&of_other[0]).into_iter().map(english).collect::<Vec<_>>());
}

#[test]
fn a_scan_prepared_with_other_weights_is_refused_by_their_names() {
    let (own, other) = (Matcher::new(), knowing([renamed()]));
    let (a, b) = (prepared(&own, body("woman-standing.ply")), prepared(&other, body("man-lunging.ply")));
    let shipped = &a.embeddings[0].weights;
    assert_eq!(shipped.name, "bodies");
    for matcher in [&own, &other] {
        let error = matcher.match_shapes(&a, &b, &MatchOptions::default()).expect_err("refused");
        assert_eq!(error.code(), "other-weights");
        assert!(
            [shipped.to_string(), "\"Koerper\" 7".to_owned()].iter().all(|id| error.to_string().contains(id)),
            "{error}"
        );
    }
    let back = PreparedShape::from_bytes(&b.to_bytes().expect("bytes")).expect("read back");
    assert_eq!(back, b, "a stored scan remembers its weights");
}

#[test]
fn of_several_categories_the_one_at_home_with_the_pair_is_taken_and_said() {
    for order in [[true, false], [false, true]] {
        let both = knowing(order.map(|own| if own { embedded().clone() } else { clueless() }));
        let [a, b] = [body("woman-standing.ply"), body("man-lunging.ply")].map(|shape| prepared(&both, shape));
        assert_eq!((a.embeddings.len(), a.category().expect("one").name.as_str()), (2, "people"));
        let found = matched(&both, &a, &b);
        assert_eq!(found.category.as_deref(), Some("people"));
        assert_eq!(found.weights.as_ref(), Some(&embedded().id()));
        let back = PreparedShape::from_bytes(&a.to_bytes().expect("bytes")).expect("read back");
        assert_eq!(back, a);
        // What was prepared with both can be matched with either.
        assert_eq!(matched(&Matcher::new(), &a, &b).a_to_b, found.a_to_b);
    }
}

#[test]
fn a_category_without_thresholds_matches_alone_and_comes_after_one_that_is_at_home() {
    let bodies = || [body("woman-standing.ply"), body("man-lunging.ply")];
    let alone = knowing([unfitted()]);
    let [a, b] = bodies().map(|shape| prepared(&alone, shape));
    let found = matched(&alone, &a, &b);
    assert_eq!(found.category.as_deref(), Some("scans"));
    assert!(found.a_to_b.confidence.iter().all(|c| (0.0..=1.0).contains(c)));
    assert_eq!(a.info.unit, None, "how large such scans are is not known");

    let both = knowing([unfitted(), embedded().clone()]);
    let [a, b] = bodies().map(|shape| prepared(&both, shape));
    assert_eq!((a.category().expect("one").name.as_str(), a.info.unit.as_deref()), ("people", Some("m")));
    assert_eq!(matched(&both, &a, &b).category.as_deref(), Some("people"));
}

#[test]
fn weights_of_ones_own_run_on_a_processor() {
    let model = Arc::new(Model::new(renamed()).expect("a network"));
    let mut processor = block_on(Processor::open(model, DeviceChoice::Cpu)).expect("the CPU");
    let shape = block_on(processor.prepare(body("man-standing.ply"), None, &options(), &mut Progress::silent()));
    assert_eq!(shape.expect("prepared").category().expect("one").name, "Leute");
}

#[test]
fn weights_without_a_sound_category_are_refused() {
    let mut weights = embedded().clone();
    weights.category.parts.truncate(13);
    let refused = Weights::from_bytes(&weights.to_bytes(true).expect("bytes")).expect_err("refused").to_string();
    assert!(refused.contains("people") && refused.contains("part 13 of 13"), "{refused}");
    let refused = Model::new(weights).expect_err("refused").to_string();
    assert!(refused.contains("part 13 of 13"), "not from a file either: {refused}");
    let mut weights = embedded().clone();
    weights.category = unfitted().category;
    let refused = Model::new(weights).expect_err("refused").to_string();
    assert!(refused.contains("parts.weight is 96 by 14 and should be 96 by 3"), "{refused}");
    let mut weights = embedded().clone();
    weights.config.map = 0;
    let refused = Model::new(weights).expect_err("refused").to_string();
    assert!(refused.contains("map is 0"), "{refused}");
}
