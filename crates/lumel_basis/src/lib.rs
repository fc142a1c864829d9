//! Fields of light and the bases they are stored in
