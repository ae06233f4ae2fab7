//! wip
use std::io::Write;
use touchoff::*;
fn main() {
    let mesh = mesh::shapes::tube(3., 5., scenes::HEIGHT, 512, 4, Unit::Millimetre).unwrap();
    for n in [1000, 5000, 10000, 20000, 1000000] {
        let t = std::time::Instant::now();
        let part = Part::from_mesh(&mesh, n, 1).unwrap();
        let b = t.elapsed();
        for path in [scenes::Path::Outside, scenes::Path::Inside, scenes::Path::Hold] {
            let poses: Vec<Pose> = (0..10000).map(|k| path.pose(k, 10000)).collect();
            let mut probe = Probe::new(&part, &tools_library::Fig73);
            let mut best = f64::MAX;
            let mut c = 0;
            let mut m = 0;
            let mut dbest = f64::MAX;
            for _ in 0..5 {
                let t = std::time::Instant::now();
                c = 0;
                m = 0;
                for p in &poses {
                    let w = probe.wrench(p);
                    c += w.colliding;
                    m = m.max(w.colliding);
                }
                best = best.min(t.elapsed().as_secs_f64());
                let t = std::time::Instant::now();
                let mut y = 0;
                for p in &poses {
                    y += probe.detect(p) as usize;
                }
                dbest = dbest.min(t.elapsed().as_secs_f64());
                std::hint::black_box(y);
            }
            std::io::stdout().flush().ok();
            println!(
                "{n} {} build {b:?} wrench {:.0} ns detect {:.0} ns colliding {:.2} max {m}",
                path.name(),
                best * 1e5,
                dbest * 1e5,
                c as f64 / 1e4
            );
        }
    }
}
