//! Postures that were touched in the page, added to a map.

use crate::bench::{Bench, cuboid, stderr, stdout};
use touchoff::TriangleId;
use touchoff_postures::PostureMap;

#[test]
fn touched_postures_are_proved_before_they_are_recorded() {
    let bench = Bench::new();
    // The block of the bench, whose top is at 0.
    let mesh = cuboid([-3.0, -3.0, -2.0], [3.0, 3.0, 0.0]);
    let is_top = |id: &TriangleId| mesh.triangle(*id).iter().all(|corner| corner.z == 0.0);
    let top: Vec<_> = mesh.ids().filter(is_top).collect();
    let row = |id: TriangleId, depth: f64| {
        let [a, b, c] = mesh.triangle(id);
        let at = (a.coords + b.coords + c.coords) / 3.0;
        format!("{},1,D2Ball,{},{},{},0,0,0,1\n", id.0, at.x, at.y, -depth)
    };
    let head = "triangle,niceness,tool,x,y,z,qx,qy,qz,qw\n";
    let run = |table: &str| {
        bench.write("touched.csv", format!("{head}{table}"));
        let inputs = "--part block.stl --unit mm --tool D2Ball --directions 9";
        bench.touchoff(&format!("sweep {inputs} --touched touched.csv -o block.postures"))
    };
    // One is 0.009 mm deep, which is allowed; one too deep; and one does not touch.
    let done = run(&(row(top[0], 0.009) + &row(top[1], 0.05) + &row(top[1], -0.05)));
    let said = stdout(&done);
    assert!(
        said.starts_with(
            "3 postures: 1 proved acceptable, at 1 triangles; 1 touch their triangle at none"
        ),
        "{said}{}",
        stderr(&done)
    );
    let stored = PostureMap::read(bench.place("block.postures")).expect("a map");
    let best = stored.row(top[0]).expect("rows").expect("a row").best;
    let [record] = &best[..] else { panic!("{best:?}") };
    assert!(record.depth >= 0.009 && record.depth < 0.0095, "{record:?}");
    assert!(record.niceness > 0.98 && record.niceness <= 1.0, "{record:?}");
    assert_eq!(stored.row(top[1]).expect("rows").map_or(0, |row| row.best.len()), 0);

    for (table, words) in [
        ("1,1,D2Bal,0,0,0,0,0,0,1\n", "line 2: the tool `D2Bal` is none of `--tool`"),
        ("999,1,D2Ball,0,0,0,0,0,0,1\n", "the part has no triangle `999`"),
        ("\n0,1,D2Ball,0,0,x,0,0,0,1\n", "line 3: the pose is not seven numbers"),
        ("0,1,D2Ball,0,0,0,0,0,0,2\n", "line 2: "),
        ("0,1\n", "the row is too short"),
    ] {
        let refused = run(table);
        assert!(
            refused.status.code() == Some(1) && stderr(&refused).contains(words),
            "{words}: {}",
            stderr(&refused)
        );
    }
}
