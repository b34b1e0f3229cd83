use geose_fmap::{operators::*, graph::*, shape::*, spectrum::*, progress::*};
fn main(){
 for a in std::env::args().skip(2){
 let s=std::fs::read_to_string(&a).unwrap(); let mut t=s.split_ascii_whitespace().skip(1).map(|x|x.parse::<f64>().unwrap());
 let n=t.next().unwrap() as usize; let m=t.next().unwrap() as usize; t.next();
 let p:Vec<[f64;3]>=(0..n).map(|_|[t.next().unwrap(),t.next().unwrap(),t.next().unwrap()]).collect();
 let f:Vec<[u32;3]>=(0..m).map(|_|{t.next();[t.next().unwrap() as u32,t.next().unwrap() as u32,t.next().unwrap() as u32]}).collect();
 let sh=Shape::new(p,f,None).unwrap();
 let kind:LaplacianKind=std::env::args().nth(1).unwrap().parse().unwrap();
 let t0=std::time::Instant::now();
 let l=laplacian(&sh,kind,&mut geose_fmap::Progress::silent()).unwrap();
 let t1=std::time::Instant::now();
 let (b,r)=spectrum(&l.matrix,&l.mass,120,&mut geose_fmap::Progress::silent()).unwrap();
 let t2=std::time::Instant::now();
 println!("{a} n={n} area={} lap {:?} spec {:?} {:?}",l.area(),t1-t0,t2-t1,r);
 println!("{:?}", (0..8).map(|i|b.eigenvalues[i]*l.area()).collect::<Vec<_>>());
 println!("{:?}", (112..120).map(|i|b.eigenvalues[i]*l.area()).collect::<Vec<_>>());
 }
}
