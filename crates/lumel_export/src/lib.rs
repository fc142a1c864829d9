//! Writes and reads lighting solutions and pictures
