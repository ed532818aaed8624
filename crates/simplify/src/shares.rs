//! How a number of triangles is divided among layers or parts.

/// The triangles of each group: as many of the wanted ones as it has of those that were `begun` with, but its floor at
/// least, for which the largest make room.
pub(crate) fn shares(wanted: usize, begun: &[usize], floors: &[usize]) -> Vec<usize> {
    let all = begun.iter().sum::<usize>().max(1);
    let mut shares: Vec<usize> =
        begun.iter().zip(floors).map(|(begun, &floor)| (wanted * begun / all).max(floor)).collect();
    while shares.iter().sum::<usize>() > wanted {
        let above = (0..shares.len()).filter(|&layer| shares[layer] > floors[layer]);
        let Some(largest) = above.max_by_key(|&layer| shares[layer]) else { break };
        shares[largest] -= 1;
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects budgets: layers share the triangles as they begin, none gets less than its floor, and together they have
    /// no more than is wanted.
    #[test]
    fn layers_share_the_triangles() {
        assert_eq!(shares(100, &[300, 100], &[1, 1]), [75, 25]);
        assert_eq!(shares(100, &[999, 1, 0], &[1, 8, 1]), [91, 8, 1]);
        assert_eq!(shares(10, &[50, 50], &[8, 8]), [8, 8]);
    }
}
