touchoff::tool! {
    tool Wave {
        units mm;
        curve side = d - 3*cos(z);
        region wave where side <= 0, 0 <= z <= 5 { depth: -side; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Wave;
}
