touchoff::tool! {
    tool Ring {
        units mm;
        profile {
            start (1, 0);
            line to (3, 0), (3, 10), (0, 10) as ring;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ring;
}
