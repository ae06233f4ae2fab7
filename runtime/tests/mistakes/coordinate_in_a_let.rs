touchoff::tool! {
    tool Cone {
        units mm;
        let half = d/2;
        region cone where half <= z, z <= 5 { depth: 5 - z; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Cone;
}
