touchoff::tool! {
    tool Cone {
        units mm;
        let slope = tan(30);
        region cone where slope*d <= z, z <= 5 { depth: min(z - slope*d, 5 - z); }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Cone;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
