touchoff::tool! {
    tool Mill {
        units mm;
        curve nose = hypot(d, z - 3) - 3;
        region tip as ball cutting where nose <= 0, z <= 3 { depth: -nose; }
        region top as ball where nose <= 0, z >= 3 { depth: -nose; }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Mill;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
