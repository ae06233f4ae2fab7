//! Rows of pieces, beside those of triangles.

use super::*;
use crate::Piece;

#[test]
fn a_triangle_is_its_smallest_pieces_that_are_complete() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(11));
    let map = place.open();
    let triangle = TriangleId(5);
    let [one, other] = Piece::whole(triangle).halves().expect("halves");
    let [third, fourth] = other.halves().expect("halves");
    let rows: Vec<MapRow> = (0..5).map(|_| any_row(&mut random)).collect();
    let known = |map: &PostureMap| map.pieces(triangle).expect("read");
    assert_eq!(known(&map), []);
    assert!(map.piece_rows().expect("read").is_empty());
    map.record(&[(triangle, rows[0].clone())]).expect("recorded");
    let whole = map.row(triangle).expect("read").expect("a row");
    map.record_pieces(&[(one, rows[1].clone())]).expect("recorded");
    assert_eq!(known(&map), [(Piece::whole(triangle), whole.clone())]);
    let more = [(other, rows[2].clone()), (third, rows[3].clone())];
    map.record_pieces(&more).expect("recorded");
    assert_eq!(known(&map), [(one, rows[1].clone()), (other, rows[2].clone())]);
    map.record_pieces(&[(fourth, rows[4].clone())]).expect("recorded");
    drop(map);
    let expected = [(one, rows[1].clone()), (third, rows[3].clone()), (fourth, rows[4].clone())];
    let map = PostureMap::read(place.path()).expect("a map");
    assert_eq!(known(&map), expected);
    assert_eq!(map.piece_rows().expect("read").len(), 4);
    // The row of the triangle is as it was.
    assert_eq!(map.row(triangle).expect("read"), Some(whole));
    let mut seen = Vec::new();
    let done: Result<(), MapError> = map.for_each_triangle(|id, pieces| {
        seen.push((id, pieces));
        Ok(())
    });
    done.expect("read");
    assert_eq!(seen, [(triangle, expected.into())]);
    let coverage = map.coverage().expect("read");
    assert_eq!((coverage.swept, coverage.divided, coverage.pieces), (1, 1, 3));
    let error = map.record_pieces(&[(one, rows[1].clone())]).expect_err("only read");
    assert!(matches!(error, MapError::ReadOnly { .. }), "{error}");
}

#[test]
fn rows_that_do_not_fit_are_refused() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(12));
    let map = place.open();
    let [piece, _] = Piece::whole(TriangleId(99)).halves().expect("halves");
    for piece in [piece, Piece::whole(TriangleId(3))] {
        let error = map.record_pieces(&[(piece, any_row(&mut random))]).expect_err("unfit");
        assert!(matches!(error, MapError::Unfit { .. }), "{error}");
    }
    assert!(map.piece_rows().expect("read").is_empty());
}

/// Other versions of the format may have written a path that is none.
#[test]
fn a_piece_that_is_none_is_damage() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(13));
    let map = place.open();
    for path in [0, 1] {
        let write = map.database.begin_write().expect("a transaction");
        let mut table = write.open_table(PIECES).expect("a table");
        table.insert((2, path), encode(&any_row(&mut random)).as_slice()).expect("room");
        drop(table);
        write.commit().expect("room");
        let error = map.piece_rows().expect_err("damage");
        assert!(matches!(error, MapError::Damaged { .. }), "{error}");
    }
}
