touchoff::tool! {
    tool Cone {
        units mm;
        region cone where 2d <= z, z <= 5 { depth: min(z - 2*d, 5 - z); }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Cone;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
