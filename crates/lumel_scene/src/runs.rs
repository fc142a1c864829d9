//! Lists of numbers that mostly count up.

/// A list of numbers, stored as its stretches that count up by one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Runs {
    /// Where each stretch begins in the list, and its first number.
    starts: Vec<(u32, u32)>,
    len: u32,
}

impl Runs {
    /// How many numbers there are.
    pub(crate) fn len(&self) -> usize {
        self.len as usize
    }

    /// The numbers in their order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = u32> {
        let ends = self.starts.iter().skip(1).map(|start| start.0).chain([self.len]);
        self.starts.iter().zip(ends).flat_map(|(&(begin, first), end)| first..first + (end - begin))
    }

    /// Where a number stands in a list that is ascending.
    pub(crate) fn position(&self, number: u32) -> Option<usize> {
        let run = self.starts.partition_point(|start| start.1 <= number).checked_sub(1)?;
        let (begin, first) = self.starts[run];
        let end = self.starts.get(run + 1).map_or(self.len, |next| next.0);
        let position = begin + (number - first);
        (position < end).then_some(position as usize)
    }
}

impl Extend<u32> for Runs {
    fn extend<I: IntoIterator<Item = u32>>(&mut self, numbers: I) {
        for number in numbers {
            let follows =
                self.starts.last().is_some_and(|&(begin, first)| first + (self.len - begin) == number);
            if !follows {
                self.starts.push((self.len, number));
            }
            self.len += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(numbers: &[u32]) -> Runs {
        let mut runs = Runs::default();
        runs.extend(numbers.iter().copied());
        runs
    }

    #[test]
    fn any_list_is_read_as_it_was_written() {
        for list in [&[][..], &[0, 1, 2], &[5, 3, 4, 4, 5, 9], &[7, 6, 5]] {
            assert_eq!(
                (runs(list).iter().collect::<Vec<_>>(), runs(list).len()),
                (list.to_vec(), list.len())
            );
        }
    }

    #[test]
    fn numbers_of_an_ascending_list_are_found_and_no_others() {
        let list = [1, 2, 3, 6, 8, 9];
        for number in 0..12 {
            assert_eq!(runs(&list).position(number), list.iter().position(|&n| n == number), "{number}");
        }
    }

    #[test]
    fn numbers_that_count_up_take_the_room_of_one() {
        assert_eq!(runs(&(0..1000).collect::<Vec<_>>()).starts.len(), 1);
    }
}
