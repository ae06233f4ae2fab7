fn main() {
    let _ = Plate;
}

touchoff::tool! {
    tool Plate "half a disc" {
        units mm;
        region plate where d <= 3, y >= 0, 0 <= z <= 1 {
            depth: min(3 - d, min(z, 1 - z));
        }
    }
}
