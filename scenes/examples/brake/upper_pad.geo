// The upper pad of brake.geo alone.
part = 3;
Include "brake.geo";
