"""Arms as chains of joints, and their inverse kinematics."""
