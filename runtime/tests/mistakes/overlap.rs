touchoff::tool! {
    tool Mill {
        units mm;
        curve nose = hypot(d, z - 3) - 3;
        region ball where nose <= 0 { depth: -nose; }
        region shank where d <= 3, 2 <= z <= 20 { depth: min(3 - d, 20 - z); }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Mill;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
