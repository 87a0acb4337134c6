#include "tests/support/film_reader.h"

#include <theora/theoradec.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace sigmaflow::test {

namespace {

/// All packets of the only stream.
class Packets {
public:
    explicit Packets(const std::string& bytes)
    {
        ogg_sync_init(&sync_);
        char* room = ogg_sync_buffer(&sync_, static_cast<long>(bytes.size()));
        std::memcpy(room, bytes.data(), bytes.size());
        ogg_sync_wrote(&sync_, static_cast<long>(bytes.size()));
    }
    ~Packets()
    {
        if (started_) ogg_stream_clear(&stream_);
        ogg_sync_clear(&sync_);
    }

    bool next(ogg_packet& packet)
    {
        while (!started_ || ogg_stream_packetout(&stream_, &packet) != 1) {
            ogg_page page;
            if (ogg_sync_pageout(&sync_, &page) != 1) return false;
            if (!started_) ogg_stream_init(&stream_, ogg_page_serialno(&page));
            started_ = true;
            ended = ogg_page_eos(&page);
            if (ogg_stream_pagein(&stream_, &page) != 0)
                throw std::runtime_error("a page of another stream");
        }
        return true;
    }

    bool ended = false;

private:
    ogg_sync_state sync_;
    ogg_stream_state stream_;
    bool started_ = false;
};

std::uint8_t byte_of(double value)
{
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0., 255.)));
}

/// ITU-R BT.601: Y in 16..235, Cb and Cr in 16..240.
render::Image picture_of(const th_ycbcr_buffer& planes, const th_info& info)
{
    render::Image image(static_cast<int>(info.pic_width), static_cast<int>(info.pic_height));
    const auto value = [&](int plane, int column, int row) {
        const th_img_plane& p = planes[plane];
        const int x = (column + static_cast<int>(info.pic_x)) * p.width / planes[0].width;
        const int y = (row + static_cast<int>(info.pic_y)) * p.height / planes[0].height;
        return static_cast<double>(p.data[y * p.stride + x]);
    };
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column) {
            const double y = 255. / 219 * (value(0, column, row) - 16);
            const double blue = 255. / 224 * (value(1, column, row) - 128);
            const double red = 255. / 224 * (value(2, column, row) - 128);
            std::uint8_t* pixel = image.pixel(column, row);
            pixel[0] = byte_of(y + 1.402 * red);
            pixel[1] = byte_of(y - 0.344136 * blue - 0.714136 * red);
            pixel[2] = byte_of(y + 1.772 * blue);
        }
    return image;
}

}

Film read_film(const std::string& bytes)
{
    Packets packets(bytes);
    th_info info;
    th_comment comment;
    th_setup_info* setup = nullptr;
    th_info_init(&info);
    th_comment_init(&comment);
    Film film;
    ogg_packet packet;
    th_dec_ctx* decoder = nullptr;
    while (packets.next(packet)) {
        if (!decoder) {
            const int header = th_decode_headerin(&info, &comment, &setup, &packet);
            if (header < 0) throw std::runtime_error("no Theora film");
            if (header > 0) continue;
            decoder = th_decode_alloc(&info, setup);
            if (!decoder) throw std::runtime_error("wrong headers");
        }
        if (th_decode_packetin(decoder, &packet, nullptr) < 0)
            throw std::runtime_error("a frame cannot be decoded");
        th_ycbcr_buffer planes;
        th_decode_ycbcr_out(decoder, planes);
        film.frames.push_back(picture_of(planes, info));
    }
    film.width = static_cast<int>(info.pic_width);
    film.height = static_cast<int>(info.pic_height);
    film.frames_per_second = static_cast<double>(info.fps_numerator) / info.fps_denominator;
    film.ended = packets.ended;
    if (decoder) th_decode_free(decoder);
    th_setup_free(setup);
    th_comment_clear(&comment);
    th_info_clear(&info);
    return film;
}

}
