touchoff::tool! {
    tool Cone {
        units mm;
        curve side = d^0.3 - 1;
        region cone where side <= 0, 0 <= z <= 5 { depth: -side; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Cone;
}
