//! The refined graph of Algorithm 1: what it keeps is along the surface, what it leaves out is across, and nothing falls apart.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::collections::BTreeSet;

use geose_fmap::graph::{EdgeGraph, RefineParams, nearest_neighbours, refine};
use shapes::{Random, Soup, blob, body, distance, fibonacci_sphere, folded_strip};

/// Lengths of shortest paths from `source`: Dijkstra without a heap, on nothing but the list of edges.
fn shortest_paths(graph: &EdgeGraph, source: usize) -> Vec<f64> {
    let n = graph.len();
    let mut adjacent = vec![vec![]; n];
    for (i, j, length) in graph.edges() {
        adjacent[i as usize].push((j as usize, length));
        adjacent[j as usize].push((i as usize, length));
    }
    let mut length = vec![f64::INFINITY; n];
    let mut done = vec![false; n];
    length[source] = 0.0;
    while let Some(next) = (0..n).filter(|&i| !done[i]).min_by(|&a, &b| length[a].total_cmp(&length[b])) {
        done[next] = true;
        adjacent[next].iter().for_each(|&(j, step)| length[j] = length[j].min(length[next] + step));
    }
    length
}

/// Sets of connected points, by walking.
fn pieces(graph: &EdgeGraph) -> BTreeSet<BTreeSet<u32>> {
    let mut unseen: BTreeSet<u32> = (0..graph.len() as u32).collect();
    let mut pieces = BTreeSet::new();
    while let Some(start) = unseen.pop_first() {
        let mut piece = BTreeSet::from([start]);
        let mut front = vec![start];
        while let Some(i) = front.pop() {
            for &j in graph.neighbours(i as usize) {
                if unseen.remove(&j) {
                    piece.insert(j);
                    front.push(j);
                }
            }
        }
        pieces.insert(piece);
    }
    pieces
}

fn edges(graph: &EdgeGraph) -> BTreeSet<(u32, u32)> {
    graph.edges().map(|(i, j, _)| (i, j)).collect()
}

/// Clumps of `size` points, each a thousandth of the distance to the next, on a square grid.
fn clumps(side: usize, size: usize) -> Soup {
    let mut random = Random(4);
    let mut points = vec![];
    for i in 0..side * side {
        let centre = [(i / side) as f64, (i % side) as f64 + 0.01 * random.sign(), 0.05 * random.sign()];
        points.extend((0..size).map(|_| centre.map(|c| c + 1e-3 * random.sign())));
    }
    Soup { points, faces: vec![] }
}

#[test]
fn neighbours_are_the_nearest_by_brute_force() {
    let points = blob(3).points;
    let neighbours = nearest_neighbours(&points, 20);
    assert_eq!((neighbours.len(), neighbours.k()), (points.len(), 20));
    for i in (0..points.len()).step_by(17) {
        let mut others: Vec<(f64, u32)> =
            (0..points.len()).filter(|&j| j != i).map(|j| (distance(points[i], points[j]), j as u32)).collect();
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (slot, (d, _)) in others[..20].iter().enumerate() {
            assert!((neighbours.distances(i)[slot] - d).abs() <= 1e-15, "point {i}");
        }
        let sets = [neighbours.of(i).to_vec(), others[..20].iter().map(|e| e.1).collect()].map(BTreeSet::from_iter);
        assert_eq!(sets[0], sets[1], "point {i}");
    }
    assert_eq!(nearest_neighbours(&points[..7], 20).k(), 6);
}

#[test]
fn among_copies_of_one_point_everyone_still_has_k_neighbours() {
    let points: Vec<[f64; 3]> = fibonacci_sphere(60).points.into_iter().flat_map(|p| [p; 40]).collect();
    let neighbours = nearest_neighbours(&points, 20);
    for i in 0..points.len() {
        assert_eq!(neighbours.of(i).len(), 20);
        assert!(!neighbours.of(i).contains(&(i as u32)) && neighbours.distances(i).iter().all(|&d| d == 0.0));
    }
}

#[test]
fn after_each_iteration_exactly_the_candidates_below_the_ratio_are_kept() {
    let params = RefineParams::default();
    let soup = folded_strip(50, 8, 1.9);
    let neighbours = nearest_neighbours(&soup.points, 20);
    let candidates = edges(&neighbours.graph());
    let mut before = nearest_neighbours(&soup.points, 5).graph();
    for iterations in 1..=3 {
        let graph = refine(&neighbours, &RefineParams { iterations, ..params });
        assert_eq!(graph.report.bridges, 0);
        let kept = edges(&graph.edges);
        assert_eq!((candidates.len(), candidates.len() - kept.len()), (graph.report.candidates, graph.report.pruned));
        assert!(kept.is_subset(&candidates));
        for i in 0..soup.points.len() as u32 {
            let d_g = shortest_paths(&before, i as usize);
            for &(_, j) in candidates.range((i, 0)..(i + 1, 0)) {
                let ratio = d_g[j as usize] / distance(soup.points[i as usize], soup.points[j as usize]);
                assert_eq!(ratio < params.ratio, kept.contains(&(i, j)), "iteration {iterations}: ({i}, {j}), {ratio}");
            }
        }
        before = graph.edges;
    }
}

#[test]
fn two_sheets_close_together_stay_apart() {
    let (n, m) = (90, 10);
    let soup = folded_strip(n, m, 1.9);
    let neighbours = nearest_neighbours(&soup.points, 20);
    // Twelve rows from the bend and from the open end. Nearer they may cross: around the bend the way along the surface is short, a corner has
    // few neighbours in its own sheet, and each iteration lets the next two or three rows in beside an edge that already crosses.
    let middle = |i: u32| (12..n / 2 - 12).contains(&(i / m));
    let across = |graph: &EdgeGraph| graph.edges().filter(|&(i, j, _)| middle(i) && j / m > n / 2).count();
    let refined = refine(&neighbours, &RefineParams::default());
    assert!(across(&neighbours.graph()) > 500, "the plain graph does cross");
    assert_eq!(across(&refined.edges), 0);
    // From the middle of one sheet to the point above it is the way round, not the gap.
    let (below, above) = (22 * m + 5, (n - 1 - 22) * m + 5);
    let way = |graph: &EdgeGraph| shortest_paths(graph, below as usize)[above as usize];
    assert!(way(&neighbours.graph()) < 4.0 && way(&refined.edges) > 18.0, "{}", way(&refined.edges));
}

#[test]
fn a_start_that_falls_apart_is_bridged_by_the_shortest_edges_that_do() {
    // Six points to a clump: the 5 nearest neighbours of each are the rest of its clump.
    let soup = clumps(6, 6);
    let neighbours = nearest_neighbours(&soup.points, 20);
    assert_eq!(pieces(&nearest_neighbours(&soup.points, 5).graph()).len(), 36);
    let graph = refine(&neighbours, &RefineParams::default());
    assert_eq!(pieces(&graph.edges), pieces(&neighbours.graph()));
    assert_eq!(graph.report.bridges, 35, "a tree of clumps");
    let longest = graph.edges.edges().map(|(_, _, d)| d).fold(0.0, f64::max);
    assert!(longest < 1.1, "bridges join neighbouring clumps: {longest}");
}

#[test]
fn pieces_of_the_neighbourhood_graph_are_the_pieces_of_the_refined_one() {
    let two = fibonacci_sphere(300).beside(&fibonacci_sphere(200).moved(|[x, y, z]| [x + 3.0, y, z]));
    for (soup, count) in [(two, 2), (clumps(5, 25), 25), (clumps(7, 3), 1), (folded_strip(40, 6, 1.2), 1)] {
        let neighbours = nearest_neighbours(&soup.points, 20);
        for k_0 in [1, 2, 5, 20] {
            let params = RefineParams { initial_neighbours: k_0, ..RefineParams::default() };
            let graph = refine(&neighbours, &params);
            assert_eq!(pieces(&graph.edges), pieces(&neighbours.graph()), "k₀ = {k_0}");
            assert_eq!(pieces(&graph.edges).len(), count, "k₀ = {k_0}");
        }
    }
}

#[test]
fn points_in_one_place_keep_their_edge() {
    let points: Vec<[f64; 3]> = fibonacci_sphere(80).points.into_iter().flat_map(|p| [p; 3]).collect();
    let graph = refine(&nearest_neighbours(&points, 20), &RefineParams::default());
    for i in (0..points.len() as u32).step_by(3) {
        assert!(graph.edges.contains(i as usize, i + 1) && graph.edges.contains(i as usize + 1, i + 2));
    }
    assert_eq!(pieces(&graph.edges).len(), 1);
}

#[test]
fn ordinary_bodies_lose_few_edges_and_stay_whole() {
    for file in shapes::BODIES.into_iter().chain(["woman-greeting-cloud.ply"]) {
        let neighbours = nearest_neighbours(body(file).points(), 20);
        let graph = refine(&neighbours, &RefineParams::default());
        println!("{file}: {:?}", graph.report);
        assert_eq!(pieces(&graph.edges).len(), 1, "{file}");
        assert!(graph.report.pruned * 100 < graph.report.candidates, "{file}: {:?}", graph.report);
    }
}
