fn main() {
    let _ = Ball;
}

touchoff::tool! {
    solid Ball "a ball" {
        units mm;
        region ball where hypot(x, y, z) <= 3 {
            depth: 3 - hypot(x, y, z);
            direction: away from (0, 0);
        }
    }
}
