//! Options, output, and what is refused in a sentence.

use super::*;

#[test]
fn the_json_holds_the_promised_names_and_no_others() {
    let set = planes("names");
    let found = set.measured(&[&ORACLE[..], &["--rotate", "so3", "--seed", "5"]].concat());
    let keys = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    let mut wanted = [
        "set",
        "mode",
        "refine",
        "network_only",
        "parts",
        "rotate",
        "oracle",
        "pairs",
        "sources",
        "age",
        "age_interval",
        "age_raw",
        "accuracy",
        "flips",
        "flipped_points",
        "part_miou",
        "part_agreement",
        "confidence_auc",
        "ece",
        "seconds_per_shape",
        "seconds_per_pair",
        "per_pair",
    ];
    wanted.sort_unstable();
    assert_eq!(keys(&found), wanted);
    assert_eq!(keys(&found["per_pair"][0]), ["age", "age_raw", "flipped", "source", "target"]);
    assert_eq!(keys(&found["accuracy"]), ["0.01", "0.02", "0.05"]);
    for (key, value) in [("set", "names"), ("mode", "mesh"), ("refine", "none"), ("parts", "none"), ("rotate", "so3")] {
        assert_eq!(found[key], value, "{key}");
    }
    assert_eq!((&found["oracle"], &found["pairs"]), (&Value::Bool(true), &Value::from(1)));
    assert!(number(&found["seconds_per_shape"]) > 0.0 && number(&found["seconds_per_pair"]) > 0.0);
    // A single source says nothing about others.
    assert_eq!((&found["sources"], &found["age_interval"]), (&Value::from(1), &Value::Null));
    // Turning changes nothing that the oracle sees.
    assert_near(&found["age"], 100.0 * 4.5 / 30.0 / (POINTS - 2) as f64);
}

#[test]
fn json_on_standard_output_stands_there_alone() {
    let set = planes("standard-output");
    let run = set.run(&[&ORACLE[..], &["--json", "-"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    let found: Value = serde_json::from_str(&run.out).expect("JSON and nothing else");
    assert_eq!(found["set"], "standard-output");
}

#[test]
fn a_limit_takes_the_pairs_that_come_first_by_hash() {
    let set = Set::new("hashed");
    let small = sheet(12, 9);
    let names = ["a", "b", "c"];
    for name in names {
        set.shape(name, &small);
        set.column(&format!("corres/{name}.vts"), 1..=small.points.len());
    }
    let lines: Vec<String> =
        names.iter().flat_map(|x| names.iter().filter(move |y| x != *y).map(move |y| format!("{x} {y}"))).collect();
    set.write("pairs.txt", lines.join("\n"));
    let options = ["--mode", "mesh", "--oracle", "--eigenpairs", "20"];
    let order = |found: &Value| -> Vec<String> {
        let pairs = found["per_pair"].as_array().expect("a list");
        pairs.iter().map(|p| format!("{} {}", p["source"].as_str().unwrap(), p["target"].as_str().unwrap())).collect()
    };
    let all = set.measured(&options);
    assert_eq!(order(&all), lines, "without a limit as they stand");
    let ends = all["age_interval"].as_array().expect("low and high");
    assert_eq!((&all["sources"], ends.len()), (&3.into(), 2));
    assert!(number(&ends[0]) <= number(&all["age"]) && number(&all["age"]) <= number(&ends[1]), "{ends:?}");
    // FNV-1a and fmix64 of these lines, worked out in Python.
    let sorted = ["a c", "c b", "a b", "c a", "b c", "b a"];
    assert_eq!(order(&set.measured(&[&options[..], &["--limit", "4"]].concat())), sorted[..4]);
    assert_eq!(order(&set.measured(&[&options[..], &["--limit", "99"]].concat())), sorted);

    // Another list of pairs.
    set.write("others.txt", "c  a\r\n");
    let others = set.folder.join("others.txt");
    let found = set.measured(&[&options[..], &["--pairs", others.to_str().unwrap()]].concat());
    assert_eq!(order(&found), ["c a"]);

    // No pairs, but shapes.
    set.write("pairs.txt", "");
    let found = set.measured(&["--mode", "cloud", "--eigenpairs", "20", "--limit", "2"]);
    assert_eq!((&found["pairs"], &found["age"], &found["per_pair"]), (&0.into(), &Value::Null, &Value::Array(vec![])));
    assert_eq!((&found["accuracy"], &found["seconds_per_pair"]), (&Value::Null, &Value::Null));
    assert!(number(&found["seconds_per_shape"]) > 0.0);
    assert!(set.refusal(&["--mode", "mesh-cloud"]).contains("has no pairs"));
    assert!(set.refusal(&["--mode", "mesh", "--oracle"]).contains("has no pairs"));
}

#[test]
fn every_malformed_file_is_refused_with_its_name_and_line() {
    let set = planes("malformed");
    let other = |values: usize| (1..=values).map(|v| format!("{v}\n")).collect::<String>();
    let bad_line = |line: usize, text: &str| {
        let mut lines: Vec<String> = (1..=POINTS - 2).map(|v| v.to_string()).collect();
        lines[line - 1] = text.to_owned();
        lines.join("\n")
    };
    let cases: Vec<(&str, String, String)> = vec![
        (
            "pairs.txt",
            "flat turned\nflat\n".into(),
            "pairs.txt, line 2: a line must hold two names of shapes, and here are 1".into(),
        ),
        ("pairs.txt", "flat round\n".into(), "pairs.txt, line 1: “round” is no shape of this set".into()),
        (
            "corres/flat.vts",
            bad_line(7, "seven"),
            "flat.vts, line 7: “seven” where a vertex of flat, or 0 for none, must stand, a whole number from 0 to 1891".into(),
        ),
        ("corres/flat.vts", bad_line(9, "1892"), "flat.vts, line 9: “1892”".into()),
        ("corres/flat.vts", bad_line(9, "-1"), "flat.vts, line 9: “-1”".into()),
        ("corres/flat.vts", bad_line(9, "1.5"), "flat.vts, line 9: “1.5”".into()),
        ("corres/flat.vts", bad_line(9, "nan"), "flat.vts, line 9: “nan”".into()),
        (
            "corres/flat.vts",
            bad_line(10, "3 4"),
            "flat.vts, line 10: a line must hold one whole number, and here are 2".into(),
        ),
        (
            "corres/flat.vts",
            bad_line(10, ""),
            "flat.vts, line 10: a line must hold one whole number, and here are 0".into(),
        ),
        ("corres/turned.vts", other(9), "turned.vts: 9 lines, but ".into()),
        ("corres/turned.vts", "0\n".repeat(POINTS - 2), "no template point is on both flat and turned".into()),
        ("corres/turned.sym.vts", bad_line(4, "-1"), "turned.sym.vts, line 4: “-1”".into()),
        ("corres/turned.sym.vts", other(9), "turned.sym.vts: 9 lines, but ".into()),
        ("shapes/flat.off", "OFF\n3 0 0\n0 0 0\n".into(), "flat.off: ".into()),
        ("shapes/flat.off", "OFF\n".into(), "flat.off: ".into()),
    ];
    for (file, text, sentence) in cases {
        let kept = std::fs::read(set.folder.join(file)).ok();
        set.write(file, text);
        let said = set.refusal(&ORACLE);
        assert!(said.contains(&sentence), "{file}: {said}, not {sentence}");
        match kept {
            Some(kept) => set.write(file, kept),
            None => std::fs::remove_file(set.folder.join(file)).expect("gone"),
        }
    }
    set.write("none.txt", "\n");
    let none = set.folder.join("none.txt");
    let listed = [&ORACLE[..], &["--pairs", none.to_str().expect("text")]].concat();
    assert!(set.refusal(&listed).contains("none.txt: there is no pair in it"));
    for vts in ["corres/flat.vts", "corres/turned.vts"] {
        std::fs::rename(set.folder.join(vts), set.folder.join(vts).with_extension("kept")).expect("renamed");
        set.write(vts, "");
    }
    assert!(set.refusal(&ORACLE).contains("the ground truth for flat has no line"));
    for vts in ["corres/flat.vts", "corres/turned.vts"] {
        std::fs::rename(set.folder.join(vts).with_extension("kept"), set.folder.join(vts)).expect("renamed");
    }
    set.shape("turned", &plane().cloud());
    assert!(set.refusal(&["--mode", "cloud"]).contains("turned of malformed has no faces, and distances are measured"));
    set.shape("turned", &plane());

    // Rows of a piece.
    std::fs::remove_file(set.folder.join("corres/flat.vts")).expect("gone");
    assert!(set.refusal(&ORACLE).contains("no ground truth for flat: corres/flat.vts, .baryc_gt or .tpl"));
    for (text, sentence) in [
        ("1 1 0 0\n", "flat.baryc_gt: 1 lines for flat, which has 1891 points"),
        ("1 1 0\n", "flat.baryc_gt, line 1: a line must hold a face and three weights, and here are 3"),
    ] {
        set.write("corres/flat.baryc_gt", text);
        assert!(set.refusal(&ORACLE).contains(sentence), "{text}");
    }
    let rows = |first: &str| format!("{first}\n{}", "1 1 0 0\n".repeat(POINTS - 1));
    set.write("corres/flat.baryc_gt", rows("3601 1 0 0"));
    assert!(
        set.refusal(&ORACLE)
            .contains("line 1: “3601” where a face of turned must stand, a whole number from 1 to 3600")
    );
    set.write("corres/flat.baryc_gt", rows("1 x 0 0"));
    assert!(set.refusal(&ORACLE).contains("line 1: “x” where a number must stand"));

    // Rows of a cloud.
    std::fs::remove_file(set.folder.join("corres/flat.baryc_gt")).expect("gone");
    set.column("corres/flat.tpl", 0..POINTS);
    set.column("corres/turned.tpl", 0..POINTS);
    let cloud = ["--mode", "cloud"];
    assert!(set.refusal(&cloud).contains("no corres/template_to_SET.txt"));
    set.column("corres/template_to_nowhere.txt", 1..=POINTS);
    assert!(set.refusal(&cloud).contains("nowhere: "));

    std::fs::remove_dir_all(set.folder.join("shapes")).expect("gone");
    assert!(set.refusal(&ORACLE).contains("shapes: "));
    assert!(run(&["evaluate", "--dataset", "/nowhere", "--mode", "mesh"]).err.contains("/nowhere: "));
}

#[test]
fn wrong_use_ends_with_2_and_what_cannot_be_done_with_1() {
    let set = planes("use");
    let code = |options: &[&str]| set.run(options).code;
    for wrong in [
        &["--mode", "mesh", "--fast"][..],
        &["--mode", "soup"],
        &[],
        &["--mode", "mesh", "--limit", "0"],
        &["--mode", "mesh", "--limit", "few"],
        &["--mode", "mesh", "--rotate", "so4"],
        &["--mode", "mesh", "--refine", "more"],
        &["--mode", "mesh", "--parts", "some"],
        &["--mode", "mesh", "--laplacian", "graph"],
        &["--mode", "mesh", "--device", "abacus"],
        &["--mode", "mesh", "--seed", "-1"],
    ] {
        assert_eq!(code(wrong), Some(2), "{wrong:?}");
    }
    assert_eq!(run(&["evaluate", "--mode", "mesh"]).code, Some(2), "no data set");
    assert!(set.refusal(&["--mode", "mesh", "--device", "webgpu"]).contains("on the CPU only"));
    assert!(set.refusal(&["--mode", "mesh", "--weights", "w.safetensors"]).contains("w.safetensors: "));
    assert!(
        set.refusal(&["--mode", "cloud", "--laplacian", "cotangent"])
            .contains("flat: a cotangent Laplacian needs faces")
    );
    assert!(set.refusal(&["--mode", "mesh", "--json", "/nowhere/found.json"]).contains("/nowhere is no folder"));
    // Out of range is wrong use, as it is for the other verbs.
    let few = set.run(&["--mode", "mesh", "--eigenpairs", "5"]);
    assert_eq!(few.code, Some(2), "{}", few.err);
    assert!(few.err.contains("eigenpairs must be between"), "{}", few.err);
    // What has nowhere to go is not made: not even the scan is read.
    for verb in [
        &["match", "/nowhere/a.off", "/nowhere/b.off", "-o", "/nowhere/map.csv"][..],
        &["laplacian", "/nowhere/a.off", "-o", "/nowhere/l.mtx"],
    ] {
        let ended = run(verb);
        assert_eq!(ended.code, Some(1), "{verb:?}");
        assert!(ended.err.contains("/nowhere is no folder"), "{}", ended.err);
    }
    // The same for the other verbs.
    let flat = set.folder.join("shapes/flat.off");
    let flat = flat.to_str().expect("text");
    let map = set.folder.join("map.csv");
    let matching = ["match", flat, flat, "-o", map.to_str().expect("text")];
    let operator = set.folder.join("l.mtx");
    let operator = ["laplacian", flat, "-o", operator.to_str().expect("text")];
    let literal = [
        "--laplacian",
        "geodesic-literal",
        "--k0",
        "6",
        "--k",
        "12",
        "--tau",
        "2",
        "--iterations",
        "2",
        "--sigma",
        "0.5",
    ];
    assert_eq!(run(&[&operator[..], &literal].concat()).code, Some(0));
    for wrong in
        [&["--laplacian", "gaussian", "--tau", "2"][..], &["--laplacian", "euclidean", "--k", "1"], &["--sigma", "1"]]
    {
        let ended = run(&[&operator[..], wrong].concat());
        assert_eq!(ended.code, Some(2), "{wrong:?}: {}", ended.err);
    }
    for verb in [&matching[..], &["info", flat], &operator] {
        assert_eq!(run(&[verb, &["--points", "3"]].concat()).code, Some(2), "{verb:?}");
        // A GPU runs the network and the match, where it is part of the program; one in software is slow.
        let on_gpu = if cfg!(feature = "gpu") && verb[0] != "laplacian" { 0 } else { 1 };
        assert_eq!(run(&[verb, &["--points", "300", "--device", "webgpu"]].concat()).code, Some(on_gpu), "{verb:?}");
        if verb[0] != "laplacian" {
            assert_eq!(run(&[verb, &["--weights", "w"]].concat()).code, Some(1), "{verb:?}");
        }
        assert_eq!(run(&[verb, &["--device", "abacus"]].concat()).code, Some(2), "{verb:?}");
        assert_eq!(
            run(&[verb, &["--device", "cpu", "--seed", "3", "--eigenpairs", "60"]].concat()).code,
            Some(0),
            "{verb:?}"
        );
    }
}

#[test]
fn weights_may_be_given_several_times_and_those_that_do_not_fit_are_named() {
    let set = planes("several-weights");
    let flat = set.folder.join("shapes/flat.off");
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/data/weights/people.safetensors");
    let cut = set.folder.join("cut.safetensors");
    let bytes = std::fs::read(own).expect("the weights that ship");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("written");
    let [flat, cut] = [&flat, &cut].map(|path| path.to_str().expect("text"));
    let info = ["info", flat, "--points", "300"];
    let both = run(&[&info[..], &["--weights", own, "--weights", own]].concat());
    assert_eq!(both.code, Some(0), "{}", both.err);
    let refused = run(&[&info[..], &["--weights", own, "--weights", cut]].concat());
    assert_eq!(refused.code, Some(1));
    assert!(refused.err.contains("cut.safetensors: "), "{}", refused.err);
}
