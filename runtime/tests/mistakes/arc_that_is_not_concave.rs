touchoff::tool! {
    tool Ball {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) concave as ball cutting;
            line to (3, 20), (0, 20) as shank;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
